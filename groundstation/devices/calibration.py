"""Where a handle's centre is, and how far it travels: kept per driver and serial number, applied to what is read.

A device that renders force is metric: only its centre is calibrated, for a scaled position with an unscaled force
would falsify the energy of the haptic port. A stick that renders none gets its travel scaled too.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Annotated

import msgspec
import tomli_w
from msgspec import Meta, Struct

from drivers.device import DeviceError, DeviceInfo, HandleState, HapticDevice, Vector3
from groundstation.errors import InputError

_SUFFIX = ".toml"
Finite = Annotated[float, Meta(ge=-10, le=10)]
Scale = Annotated[float, Meta(ge=0.2, le=5.0)]


class Calibration(Struct, frozen=True, forbid_unknown_fields=True):
    """What was measured of one device.

    Attributes:
        name: Of the device, for people.
        made: When, ISO 8601.
        center: Where its handle rests, m, as the driver says it.
        scale: What each axis' displacement from there is multiplied with.
    """

    name: str
    made: str
    center: tuple[Finite, Finite, Finite] = (0.0, 0.0, 0.0)
    scale: tuple[Scale, Scale, Scale] = (1.0, 1.0, 1.0)


def calibrations_folder() -> Path:
    """Return where calibrations are kept: `devices/` in the user's configuration folder."""
    import platformdirs

    return Path(platformdirs.user_config_dir("groundstation", appauthor=False)) / "devices"


def calibration_path(folder: Path, driver: str, serial: str) -> Path:
    """Return the file of one device; devices without a serial number share their driver's."""
    safe = re.sub(r"[^\w.-]", "_", serial) or "any"
    return folder / f"{driver}-{safe}{_SUFFIX}"


def load_calibration(path: Path) -> Calibration | None:
    """Read a calibration, or None where there is none.

    Raises:
        InputError: The file is there and cannot be used; in one sentence.
    """
    try:
        return msgspec.convert(tomllib.loads(path.read_text(encoding="utf-8")), Calibration, strict=True)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check its permissions.") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: {error}; run `groundstation devices calibrate` again.") from error


def save_calibration(path: Path, calibration: Calibration) -> None:
    """Write a calibration; the file is either the old one or the new one, never half of it.

    Raises:
        InputError: It cannot be written.
    """
    new = path.with_suffix(".new")
    text = tomli_w.dumps(msgspec.structs.asdict(calibration))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        new.write_text(text, encoding="utf-8")
        new.replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); check the folder.") from error


class Calibrated:
    """A device with its calibration applied; one without stays as it is.

    Args:
        device: As its driver has it.
        driver: Name of its driver.
        folder: Where calibrations are.
    """

    def __init__(self, device: HapticDevice, driver: str, folder: Path) -> None:
        self._device = device
        self._driver = driver
        self._folder = folder
        self._calibration: Calibration | None = None

    @property
    def info(self) -> DeviceInfo:
        """What the device is."""
        return self._device.info

    def open(self) -> None:
        """Take the device, and its calibration from its file.

        Raises:
            DeviceError: It cannot be opened, or its calibration cannot be used.
        """
        self._device.open()
        path = calibration_path(self._folder, self._driver, self.info.serial)
        try:
            self._calibration = load_calibration(path)
        except InputError as error:
            raise DeviceError(str(error)) from error

    def read(self) -> HandleState:
        """Return the handle's state, from its calibrated centre."""
        state, calibration = self._device.read(), self._calibration
        return state if calibration is None else applied(calibration, state)

    def write_force(self, force: Vector3) -> None:
        """Render a force on the hand."""
        self._device.write_force(force)

    def close(self) -> None:
        """Let the device go."""
        self._device.close()


def applied(calibration: Calibration, state: HandleState) -> HandleState:
    """Return a state with its position and velocity as calibrated."""
    (x, y, z), (u, v, w) = state.position, state.velocity
    (a, b, c), (p, q, r) = calibration.center, calibration.scale
    return state._replace(position=((x - a) * p, (y - b) * q, (z - c) * r), velocity=(u * p, v * q, w * r))


def measured(info: DeviceInfo, made: str, resting: list[Vector3], swept: list[Vector3]) -> Calibration:
    """Return the calibration that recorded positions give.

    Args:
        info: Of the device.
        made: When, ISO 8601.
        resting: Positions, m, with the handle let go or held in its middle.
        swept: Positions with the handle moved through its whole travel; empty for a device that renders force.

    Raises:
        InputError: The handle was moved while it should rest, was not moved far enough, or is far off its middle.
    """
    center = _middle(resting)
    spread = max(
        max(abs(value - mid) for value in axis) for axis, mid in zip(_axes(resting), center, strict=True)
    )
    if spread > 0.02 * info.workspace:
        raise InputError(
            f"the handle moved by {1e3 * spread:.1f} mm while it should rest; "
            "let it go, or hold it still, and try again."
        )
    if max(map(abs, center)) > 0.5 * info.workspace:
        raise InputError("the handle is far off its middle; centre it and try again.")
    if not swept:
        return Calibration(info.name, made, center)
    scale = tuple(
        _scale(info.workspace, [value - mid for value in axis])
        for axis, mid in zip(_axes(swept), center, strict=True)
    )
    x, y, z = scale
    return Calibration(info.name, made, center, (x, y, z))


def _scale(workspace: float, travel: list[float]) -> float:
    """Return what makes the shorter side of a travel full travel; an axis that was not moved has none."""
    reach = min(max(travel), -min(travel))
    if reach < 0.01 * workspace:
        return 1.0
    scale = workspace / reach
    if not 0.2 <= scale <= 5.0:
        raise InputError(
            f"an axis travelled {1e3 * reach:.1f} mm of {1e3 * workspace:.0f} mm; move the handle all the way round."
        )
    return scale


def _axes(positions: list[Vector3]) -> list[list[float]]:
    return [[position[axis] for position in positions] for axis in range(3)]


def _middle(positions: list[Vector3]) -> Vector3:
    x, y, z = (sum(axis) / len(axis) for axis in _axes(positions))
    return x, y, z
