"""Force Dimension's delta, omega, sigma and lambda, through their maker's SDK.

`forcedimension-core` is a thin layer over the SDK's library, which it loads when it is imported; both are looked for
only when a device is opened or listed. Each `read` and each `write_force` is a transfer of about 0.25 ms, for the SDK
answers at up to 4 kHz: they wait that long, and nothing is older.

The device's frame is x toward the operator, y to the right, z up: the handle frame's x is its −x, and y its −y.
"""

from __future__ import annotations

import contextlib
import io
import math
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.discovery import Found, unusable
from drivers.vectors import finite, inside, within

FAMILY = "Force Dimension"
PACKAGE_REMEDY = "pip install 'groundstation[force-dimension]'"
SDK_REMEDY = "install the Force Dimension SDK, 3.16 or later, and set FDSDK to its folder"
RATE = 1000.0
STIFFNESS_LIMIT = 2000.0
"""Far below what the maker tells of any of them (14.5 kN/m), N/m."""

FARTHEST = 0.5
FASTEST = 10.0
SILENCE_S = 0.05
STATUS_S = 0.02
"""How often it is asked whether it knows where it is."""

_ALL_BUTTONS = 0xFFFFFFFF


class Model(NamedTuple):
    """What a family of devices can: radius of its workspace, m, and its largest force, N."""

    workspace: float
    force: float


MODELS = {
    "delta": Model(0.2, 20.0),
    "omega": Model(0.055, 12.0),
    "sigma": Model(0.065, 20.0),
    "lambda": Model(0.1, 20.0),
}
"""The spheres within the cylinders that the maker's data sheets give, and continuous forces."""

CAUTIOUS = Model(0.05, 5.0)
"""For a model that is none of these."""


class ForceDimension:
    """A device of Force Dimension's.

    Args:
        address: "" for the first one, or its serial number.
        clock: Monotonic seconds.

    Attributes:
        refused: Samples that were not believed since it was opened.

    Raises:
        DeviceError: The address is no serial number.
    """

    def __init__(self, address: str, clock: Callable[[], float] = time.monotonic) -> None:
        if address and not address.isdecimal():
            raise DeviceError(
                f"{address}: this is no serial number of a {FAMILY} device; it has digits only."
            )
        self._address = address
        self._clock = clock
        self._dhd: Any = None
        self._drd: Any = None
        self._id = -1
        self._info = _info("", "", has_wrist=False)
        self._rest()

    @property
    def info(self) -> DeviceInfo:
        """What the device is; valid once it is open."""
        return self._info

    def open(self) -> None:
        """Take the device. It compensates the weight of its own arms from now on.

        Raises:
            DeviceError: Package or SDK is missing, there is no such device, or it is in use.
        """
        self.close()
        self._dhd, self._drd = library()
        dhd = self._dhd
        number = dhd.openSerial(int(self._address)) if self._address else dhd.open()
        if number < 0:
            what = f"device {self._address}" if self._address else "device"
            raise DeviceError(
                f"No {FAMILY} {what} can be opened ({_last(dhd)}); plug it in and switch it on."
            )
        self._id = number
        self._rest()
        serial_number = dhd.getSerialNumber(number)
        name = dhd.getSystemName(number) or ""
        self._wrist = bool(dhd.hasWrist(number))
        self._info = _info(name, str(serial_number) if serial_number >= 0 else "", has_wrist=self._wrist)
        try:
            self._check(dhd.enableForce(True, number))  # noqa: FBT003 - the SDK's
            self._check(dhd.setForce(ZERO3, number))
        except DeviceError:
            self.close()
            raise

    def read(self) -> HandleState:
        """Return where the handle is.

        Raises:
            DeviceError: It does not answer, says what cannot be for 50 ms, or is not open.
        """
        dhd = self._opened()
        now = self._clock()
        self._ask_status(now)
        self._check(dhd.getPosition(self._place, self._id))
        # It has none until it was asked for two positions.
        if dhd.getLinearVelocity(self._speed, self._id) < 0:
            self._speed[:] = ZERO3
        yaw = self._yaw(dhd) if self._wrist else 0.0
        return self._believed(now, yaw, dhd.getButtonMask(self._id))

    def write_force(self, force: Vector3) -> None:
        """Render a force, N; none while the device does not know where it is.

        Raises:
            DeviceError: It is not finite (then it is zero), or the device does not answer or is not open.
        """
        dhd = self._opened()
        if not finite(force):
            dhd.setForce(ZERO3, self._id)
            raise DeviceError(f"{self._info.name}: the force is not a number; it is set to zero.")
        x, y, z = within(force, self._info.force_limit) if self._homed else ZERO3
        self._check(dhd.setForce((-x, -y, z), self._id))

    def close(self) -> None:
        """Render nothing and let the device go."""
        number, self._id = self._id, -1
        if number >= 0:
            self._dhd.setForce(ZERO3, number)
            self._dhd.enableForce(False, number)  # noqa: FBT003 - the SDK's
            self._dhd.close(number)

    def _rest(self) -> None:
        self._place = [0.0, 0.0, 0.0]
        self._speed = [0.0, 0.0, 0.0]
        self._frame = [[0.0, 0.0, 0.0] for _ in range(3)]
        self._wrist = self._homed = False
        self._status_t = -math.inf
        self._newest: HandleState | None = None
        self.refused = 0

    def _ask_status(self, now: float) -> None:
        if now - self._status_t >= STATUS_S:
            self._status_t = now
            self._homed = bool(self._drd.isInitialized(self._id))

    def _yaw(self, dhd: Any) -> float:  # noqa: ANN401 - a module
        self._check(dhd.getOrientationFrame(self._frame, self._id))
        return math.atan2(self._frame[1][0], self._frame[0][0])

    def _believed(self, now: float, yaw: float, buttons: int) -> HandleState:
        """Return a sample that can be, or the last one that could for 50 ms."""
        x, y, z = self._place
        u, v, w = self._speed
        place, velocity = (-x, -y, z), (-u, -v, w)
        if inside(place, FARTHEST) and inside(velocity, FASTEST) and math.isfinite(yaw):
            place = within(place, self._info.workspace)
            self._newest = HandleState(place, velocity, yaw, buttons & _ALL_BUTTONS, self._homed, now)
            return self._newest
        self.refused += 1
        if self._newest is None or now - self._newest.device_time > SILENCE_S:
            raise DeviceError(f"{self._info.name}: what it measures cannot be; switch it off and on.")
        return self._newest

    def _check(self, code: int) -> None:
        if code < 0:
            raise DeviceError(f"{self._info.name}: it does not answer ({_last(self._dhd)}); check its cable.")

    def _opened(self) -> Any:  # noqa: ANN401 - a module
        if self._id < 0:
            raise DeviceError(f"{self._info.name}: it is not open; open it first.")
        return self._dhd


def library() -> tuple[Any, Any]:
    """Return the modules `dhd` and `drd` of `forcedimension-core`, with the SDK loaded.

    Raises:
        DeviceError: The package or the SDK is missing.
    """
    complaint = io.StringIO()
    try:
        # It complains on stderr of an SDK that it does not find; that is said below.
        with contextlib.redirect_stderr(complaint):
            from forcedimension_core import dhd, drd
    except ModuleNotFoundError as error:
        raise DeviceError(f"The package {error.name} is missing; run: {PACKAGE_REMEDY}") from error
    except (ImportError, AttributeError, OSError) as error:
        why = " ".join(complaint.getvalue().split()) or str(error)
        raise DeviceError(f"The {FAMILY} SDK cannot be loaded ({why.rstrip('.')}); {SDK_REMEDY}.") from error
    return dhd, drd


def discover() -> list[Found]:
    """Return the devices that are there and that no program has open."""
    try:
        dhd, _ = library()
    except DeviceError as error:
        remedy = PACKAGE_REMEDY if PACKAGE_REMEDY in str(error) else SDK_REMEDY
        why = "its Python package is missing" if remedy is PACKAGE_REMEDY else "its SDK cannot be loaded"
        return [unusable("force-dimension", FAMILY, why, remedy)]
    free, all_of_them = dhd.getAvailableCount(), dhd.getDeviceCount()
    return [_found("", usable=index < free) for index in range(max(all_of_them, 0))]


def _found(serial_number: str, *, usable: bool) -> Found:
    return Found(
        driver="force-dimension",
        uri=f"force-dimension:{serial_number}".rstrip(":"),
        name=FAMILY,
        serial=serial_number,
        port="USB",
        renders="force",
        rate=RATE,
        usable=usable,
        why="" if usable else "another program has it open",
        remedy="" if usable else "end that program",
    )


def _last(dhd: Any) -> str:  # noqa: ANN401 - a module
    return str(dhd.errorGetLastStr()).rstrip(".")


def _info(name: str, serial_number: str, *, has_wrist: bool) -> DeviceInfo:
    model = next((model for family, model in MODELS.items() if family in name.lower()), CAUTIOUS)
    return DeviceInfo(
        name=f"{FAMILY} {name}".rstrip(),
        serial=serial_number,
        axes=4 if has_wrist else 3,
        workspace=model.workspace,
        force_limit=model.force,
        stiffness_limit=STIFFNESS_LIMIT,
        rate=RATE,
        renders="force",
    )
