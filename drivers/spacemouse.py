"""3Dconnexion's SpaceMouse, by `pyspacemouse`: a cap that is pushed, pulled and twisted, and does not push back.

It measures how far the cap is displaced, which is taken for the handle's place: the full way is the workspace's
radius, and a full twist a radian. Roll and pitch are not used. It reports while the cap is displaced and once when it
is let go; so rest may be silent, and a displaced cap that is silent for 0.2 s is not believed any more.
"""

from __future__ import annotations

import contextlib
import io
import os
import time
from collections.abc import Callable
from typing import Any

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.discovery import Found, unusable
from drivers.smooth import Smooth
from drivers.vectors import finite, inside, within

NAME = "SpaceMouse"
PACKAGE_REMEDY = "pip install 'groundstation[spacemouse]'"
LIBRARY_REMEDY = "sudo apt-get install libhidapi-hidraw0"
RULE_REMEDY = (
    "printf '"
    'SUBSYSTEM=="hidraw", ATTRS{idVendor}=="256f", TAG+="uaccess"\\n'
    'SUBSYSTEM=="hidraw", ATTRS{idVendor}=="046d", ATTRS{idProduct}=="c6*", TAG+="uaccess"\\n'
    "' | sudo tee /etc/udev/rules.d/60-spacemouse.rules && sudo udevadm control --reload && sudo udevadm trigger"
)
"""3Dconnexion's vendor number, and Logitech's, under which the older ones are."""

WORKSPACE = 0.1
FULL_YAW = 1.0
FORCE_LIMIT = 10.0
STIFFNESS_LIMIT = 1000.0
RATE = 125.0
"""As often as it reports, Hz."""

SILENCE_S = 0.2
FARTHEST = 2.0
"""Times the full way; some caps give a little more than their full way."""

MOST_REPORTS = 32


class SpaceMouse:
    """A SpaceMouse.

    Args:
        address: "" for the first one, its path (`/dev/hidraw3`), or part of its model's name.
        clock: Monotonic seconds.

    Attributes:
        refused: Reports that were not believed since it was opened.
    """

    def __init__(self, address: str, clock: Callable[[], float] = time.monotonic) -> None:
        self._address = address
        self._clock = clock
        self._mouse: Any = None
        self._info = _info(NAME, "")
        self._rest()

    @property
    def info(self) -> DeviceInfo:
        """What the device is."""
        return self._info

    def open(self) -> None:
        """Take the device.

        Raises:
            DeviceError: There is none, it may not be read, or a library is missing.
        """
        self.close()
        path, model = _chosen(connected(), self._address)
        library = _library()
        try:
            # The library says on stdout what it found.
            with contextlib.redirect_stdout(io.StringIO()):
                convention = library.AxisConvention.ROS
                self._mouse = library.open_by_path(path, callback=self._take, axis_convention=convention)
        except (OSError, RuntimeError, ValueError) as error:
            why, remedy = _fault(path) or (str(error), "unplug it, plug it in again")
            raise DeviceError(f"{model} at {path} cannot be opened: {why}; {remedy}.") from error
        self._info = _info(model, str(self._mouse.serial_number))
        self._rest()

    def read(self) -> HandleState:
        """Return where the cap is.

        Raises:
            DeviceError: It is gone, silent while it is displaced, or not open.
        """
        mouse = self._opened()
        self._listen(mouse)
        now = self._clock()
        if (self._doubtful or self._displaced()) and now - self._heard_t > SILENCE_S:
            raise DeviceError(f"{self._info.name}: it is silent; plug it in again, or charge it.")
        place = within(self._place, WORKSPACE)
        self._smooth.add(now, place)
        t = self._heard_t if self._displaced() else now
        return HandleState(place, self._smooth.velocity, self._yaw, self._buttons, homed=True, device_time=t)

    def write_force(self, force: Vector3) -> None:
        """Render nothing.

        Raises:
            DeviceError: The force is not finite, or the device is not open.
        """
        self._opened()
        if not finite(force):
            raise DeviceError(f"{self._info.name}: the force is not a number.")

    def close(self) -> None:
        """Let the device go."""
        mouse, self._mouse = self._mouse, None
        if mouse is not None:
            mouse.close()

    def _rest(self) -> None:
        self._place: Vector3 = ZERO3
        self._yaw = 0.0
        self._buttons = 0
        self._heard_t = self._clock()
        self._doubtful = self._came = False
        self._smooth = Smooth()
        self.refused = 0

    def _displaced(self) -> bool:
        return self._place != ZERO3 or self._yaw != 0.0

    def _listen(self, mouse: Any) -> None:  # noqa: ANN401 - the library has no types
        """Take the reports that came; each call of the library's reads one and hands it to `_take`."""
        from easyhid import HIDException

        for _ in range(MOST_REPORTS):
            self._came = False
            try:
                mouse.read()
            except HIDException as error:
                raise DeviceError(f"{self._info.name}: it is gone; plug it in again.") from error
            if not self._came:
                return

    def _take(self, state: Any) -> None:  # noqa: ANN401 - the library has no types
        """Take the state after a report."""
        self._came = True
        place = (state.x, state.y, state.z)
        self._doubtful = not (inside(place, FARTHEST) and abs(state.yaw) <= FARTHEST)
        if self._doubtful:
            self.refused += 1
            return
        x, y, z = place
        self._place = (x * WORKSPACE, y * WORKSPACE, z * WORKSPACE)
        self._yaw = FULL_YAW * max(-1.0, min(1.0, state.yaw))
        self._buttons = sum(bool(pressed) << bit for bit, pressed in enumerate(state.buttons[:32]))
        self._heard_t = self._clock()

    def _opened(self) -> Any:  # noqa: ANN401 - the library has no types
        if self._mouse is None:
            raise DeviceError(f"{self._info.name}: it is not open; open it first.")
        return self._mouse


def connected() -> dict[str, str]:
    """Return the models of the SpaceMouses there are, by path.

    Raises:
        DeviceError: A library is missing.
    """
    try:
        return _library().get_connected_devices_by_path()
    except RuntimeError as error:
        raise DeviceError(f"The library hidapi is missing; run: {LIBRARY_REMEDY}") from error


def discover() -> list[Found]:
    """Return the SpaceMouses there are, those too that this user may not read."""
    try:
        there = connected()
    except DeviceError as error:
        remedy = PACKAGE_REMEDY if PACKAGE_REMEDY in str(error) else LIBRARY_REMEDY
        missing = "pyspacemouse" if remedy is PACKAGE_REMEDY else "hidapi"
        return [unusable("spacemouse", NAME, f"the library {missing} is missing", remedy)]
    return [_found(path, model) for path, model in sorted(there.items())]


def _found(path: str, model: str) -> Found:
    fault = _fault(path)
    why, remedy = fault or ("", "")
    return Found(
        driver="spacemouse",
        uri=f"spacemouse:{path}",
        name=model,
        serial="",
        port=path,
        renders="nothing",
        rate=RATE,
        usable=fault is None,
        why=why,
        remedy=remedy,
    )


def _fault(path: str) -> tuple[str, str] | None:
    return None if os.access(path, os.R_OK) else ("you may not read this device", RULE_REMEDY)


def _chosen(there: dict[str, str], address: str) -> tuple[str, str]:
    for path, model in sorted(there.items()):
        if address in {"", path} or ("/" not in address and address.lower() in model.lower()):
            return path, model
    if not there:
        raise DeviceError("No SpaceMouse is connected; plug one in, see `groundstation devices`.")
    others = ", ".join(f"{model} at {path}" for path, model in sorted(there.items()))
    raise DeviceError(f"{address}: no SpaceMouse is known by this; connected: {others}.")


def _library() -> Any:  # noqa: ANN401 - the library has no types
    try:
        import pyspacemouse
    except ImportError as error:
        raise DeviceError(f"The package pyspacemouse is missing; run: {PACKAGE_REMEDY}") from error
    return pyspacemouse


def _info(model: str, serial_number: str) -> DeviceInfo:
    return DeviceInfo(
        name=model,
        serial=serial_number,
        axes=4,
        workspace=WORKSPACE,
        force_limit=FORCE_LIMIT,
        stiffness_limit=STIFFNESS_LIMIT,
        rate=RATE,
        renders="nothing",
    )
