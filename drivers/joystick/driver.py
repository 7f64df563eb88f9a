"""Any joystick or gamepad that SDL knows.

A stick has no metres: its full way is the workspace's radius, and full yaw a radian. What `read` returns is fresh as
long as the device is plugged in, for a joystick tells only what changes.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable
from pathlib import Path

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.discovery import Found, unusable
from drivers.joystick import rendering, sdl, sticks
from drivers.smooth import Smooth
from drivers.vectors import finite, within

WORKSPACE = 0.1
FULL_YAW = 1.0
STIFFNESS_LIMIT = 100.0
"""At the edge of the workspace this is all the force there is, N/m."""

UNFELT_STIFFNESS = 1000.0
"""Where no force acts on the hand, none makes it unstable, N/m."""

RATE = 250.0
"""As often as the quickest of them report, Hz."""

_NONE = DeviceInfo(
    name="Joystick",
    serial="",
    axes=0,
    workspace=WORKSPACE,
    force_limit=0.0,
    stiffness_limit=0.0,
    rate=RATE,
    renders="nothing",
)
_INPUTS = Path("/proc/bus/input/devices")


class Joystick:
    """A joystick or gamepad.

    Args:
        address: "" for the first one, or its GUID, serial number, or part of its name.
        clock: Monotonic seconds.
        mode: Which stick does what on a gamepad, 1 to 4, as in radio control; see `sticks`.
        deadzone: Share of a stick's way, around its middle, that counts as none.
        axes: Which axis does what on another joystick, as `{forward = "-1", left = "-0"}`.

    Raises:
        DeviceError: A setting is none.
    """

    def __init__(
        self,
        address: str,
        clock: Callable[[], float] = time.monotonic,
        *,
        mode: object = 2,
        deadzone: object = sticks.DEFAULT_DEADZONE,
        axes: object = None,
    ) -> None:
        self._address = address
        self._clock = clock
        self._gamepad_sources = sticks.gamepad(mode)
        self._zone = sticks.deadzone(deadzone)
        self._chosen = None if axes is None else sticks.chosen(axes)
        self._joystick: sdl.Joystick | None = None
        self._renderer: rendering.Renderer = rendering.Nothing()
        self._info = _NONE

    @property
    def info(self) -> DeviceInfo:
        """What it is; valid once it is open."""
        return self._info

    def open(self) -> None:
        """Take the joystick, and find out how it can answer.

        Raises:
            DeviceError: There is none, it cannot be opened, or SDL is missing.
        """
        self.close()
        joystick = sdl.Joystick(self._address)
        self._joystick = joystick
        self._sources = self._gamepad_sources
        if not joystick.is_gamepad:
            self._sources = self._chosen or sticks.flight_stick(len(joystick.axes()))
        self._renderer = rendering.best(joystick)
        self._sparing = rendering.Sparing(self._renderer, self._clock)
        self._smooth = Smooth()
        self._info = _info(joystick.identity, self._sources, self._renderer)

    def read(self) -> HandleState:
        """Return where the sticks are.

        Raises:
            DeviceError: It was unplugged, or is not open.
        """
        joystick = self._opened()
        sdl.update()
        if not joystick.attached():
            raise DeviceError(f"{joystick.identity.name}: it is gone; plug it in again.")
        now = self._clock()
        forward, left, up, yaw = sticks.deflection(joystick.axes(), self._sources, self._zone)
        position = within((forward * WORKSPACE, left * WORKSPACE, up * WORKSPACE), WORKSPACE)
        self._smooth.add(now, position)
        return HandleState(
            position, self._smooth.velocity, yaw * FULL_YAW, joystick.buttons(), homed=True, device_time=now
        )

    def write_force(self, force: Vector3) -> None:
        """Render a force, N, as far as it can; all of it at 10 N.

        Raises:
            DeviceError: It is not finite (then it is zero), or the joystick is not open.
        """
        self._opened()
        if not finite(force):
            self._sparing.render(ZERO3)
            raise DeviceError(f"{self._info.name}: the force is not a number; it is set to zero.")
        self._sparing.render(force)

    def close(self) -> None:
        """Render nothing and let it go."""
        joystick, self._joystick = self._joystick, None
        renderer, self._renderer = self._renderer, rendering.Nothing()
        if joystick is not None:
            renderer.close()
            joystick.close()

    def _opened(self) -> sdl.Joystick:
        if self._joystick is None:
            raise DeviceError("The joystick is not open; open it first.")
        return self._joystick


def discover() -> list[Found]:
    """Return the joysticks there are, those too that this user may not read."""
    try:
        there = sdl.connected()
    except DeviceError:
        return [unusable("joystick", "Joysticks and gamepads", "the package pysdl2 is missing", sdl.REMEDY)]
    return [_found(identity) for identity in there] + _forbidden(_INPUTS, os.access)


def _found(identity: sdl.Identity) -> Found:
    device = Joystick(identity.serial or identity.guid)
    try:
        device.open()
    except DeviceError as error:
        return unusable("joystick", identity.name, str(error).rstrip("."), "unplug it, plug it in again")
    info = device.info
    device.close()
    return Found(
        driver="joystick",
        uri=f"joystick:{info.serial}",
        name=info.name,
        serial=info.serial,
        port=identity.path,
        renders=info.renders,
        rate=info.rate,
    )


def _forbidden(inputs: Path, allowed: Callable[[str, int], bool]) -> list[Found]:
    """Return the joysticks of Linux's list of inputs that this user may not read; SDL passes them over."""
    found: list[Found] = []
    text = inputs.read_text(errors="replace") if inputs.is_file() else ""
    for block in text.split("\n\n"):
        name = re.search(r'^N: Name="(.*)"', block, re.MULTILINE)
        handlers = re.search(r"^H: Handlers=(.*)", block, re.MULTILINE)
        words = handlers.group(1).split() if handlers else []
        events = [f"/dev/input/{word}" for word in words if word.startswith("event")]
        is_joystick = any(re.fullmatch(r"js\d+", word) for word in words)
        if is_joystick and events and not allowed(events[0], os.R_OK | os.W_OK):
            why, remedy = (
                f"you may not read and write {events[0]}",
                'sudo usermod -aG input "$USER", and log in again',
            )
            found.append(unusable("joystick", name.group(1) if name else "Joystick", why, remedy))
    return found


def _info(identity: sdl.Identity, sources: sticks.Sources, renderer: rendering.Renderer) -> DeviceInfo:
    return DeviceInfo(
        name=identity.name or "Joystick",
        serial=identity.serial or identity.guid,
        axes=sum(source is not None for source in sources),
        workspace=WORKSPACE,
        force_limit=rendering.FULL_FORCE,
        stiffness_limit=STIFFNESS_LIMIT if renderer.renders == "force" else UNFELT_STIFFNESS,
        rate=RATE,
        renders=renderer.renders,
    )
