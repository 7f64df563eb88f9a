"""SDL 2 as far as it is needed here: the joysticks there are, and one of them open.

Only the joystick and haptic parts are started: no window, no video, no signal handlers, no queue of events that
somebody would have to empty. They run until the process ends; SDL notices what is plugged in and out whenever it is
updated.
"""

from __future__ import annotations

import warnings
from types import ModuleType
from typing import Any, NamedTuple

from drivers.device import DeviceError

REMEDY = "pip install 'groundstation[joystick]'"
MOST_AXES = 16
MOST_BUTTONS = 32

_GAMEPAD_AXES = 4
_LEFT_TRIGGER, _RIGHT_TRIGGER = 4, 5
_GAMEPAD_BUTTONS = 21
_TRIGGERED = 16384
_started: list[ModuleType] = []


class Identity(NamedTuple):
    """What a joystick is known by, however often it is plugged in and out.

    Attributes:
        guid: SDL's, 32 hexadecimal digits: bus, vendor, product, version; equal for equal models.
        serial: The device's own, or "".
        name: For people.
        path: Where it is now.
    """

    guid: str
    serial: str
    name: str
    path: str

    def known_as(self, address: str) -> bool:
        """Say whether the user means this one: by GUID, serial number, or part of the name; "" is any."""
        exact = address.lower() in {"", self.guid.lower(), self.serial.lower()}
        return exact or address.lower() in self.name.lower()


def sdl() -> Any:  # noqa: ANN401 - pysdl2 has no types
    """Return pysdl2's module, with SDL started.

    Raises:
        DeviceError: It is not installed, or SDL cannot start.
    """
    if not _started:
        _started.append(_start())
    return _started[0]


def update() -> None:
    """Let SDL take note of everything that happened to joysticks since the last time."""
    sdl().SDL_JoystickUpdate()


def connected() -> list[Identity]:
    """Return the joysticks there are."""
    update()
    return [identity for index in range(sdl().SDL_NumJoysticks()) if (identity := _identity(index))]


class Joystick:
    """An open joystick.

    Args:
        address: "" for the first one, or what it is known by.

    Attributes:
        identity: Which one it is.
        handle: SDL's, for what renders.
        is_gamepad: It has two sticks, and SDL knows which axis is which.

    Raises:
        DeviceError: There is none, or it cannot be opened.
    """

    def __init__(self, address: str) -> None:
        self._sdl = sdl()
        index, self.identity = _find(address)
        self.is_gamepad = bool(self._sdl.SDL_IsGameController(index))
        self._gamepad = self._sdl.SDL_GameControllerOpen(index) if self.is_gamepad else None
        self.handle = self._sdl.SDL_JoystickOpen(index)
        if not self.handle or (self.is_gamepad and not self._gamepad):
            why = self._sdl.SDL_GetError().decode(errors="replace")
            raise DeviceError(
                f"{self.identity.name}: it cannot be opened ({why}); unplug it, plug it in again."
            )
        self._axes = min(self._sdl.SDL_JoystickNumAxes(self.handle), MOST_AXES)
        self._buttons = min(self._sdl.SDL_JoystickNumButtons(self.handle), MOST_BUTTONS)

    def attached(self) -> bool:
        """Say whether it is still plugged in, as of the last update."""
        return bool(self._sdl.SDL_JoystickGetAttached(self.handle))

    def axes(self) -> list[int]:
        """Return its axes as of the last update; a gamepad's are left x, left y, right x, right y."""
        if self.is_gamepad:
            return [self._sdl.SDL_GameControllerGetAxis(self._gamepad, axis) for axis in range(_GAMEPAD_AXES)]
        return [self._sdl.SDL_JoystickGetAxis(self.handle, axis) for axis in range(self._axes)]

    def buttons(self) -> int:
        """Return one bit a button: a gamepad's in SDL's order, A first, then left and right trigger."""
        bits = 0
        if not self.is_gamepad:
            for button in range(self._buttons):
                bits |= self._sdl.SDL_JoystickGetButton(self.handle, button) << button
            return bits
        for button in range(_GAMEPAD_BUTTONS):
            bits |= self._sdl.SDL_GameControllerGetButton(self._gamepad, button) << button
        for place, axis in enumerate((_LEFT_TRIGGER, _RIGHT_TRIGGER), _GAMEPAD_BUTTONS):
            bits |= (self._sdl.SDL_GameControllerGetAxis(self._gamepad, axis) > _TRIGGERED) << place
        return bits

    def close(self) -> None:
        """Let it go."""
        if self._gamepad:
            self._sdl.SDL_GameControllerClose(self._gamepad)
        self._sdl.SDL_JoystickClose(self.handle)


def _start() -> ModuleType:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it tells where it found SDL
            import sdl2
    except ImportError as error:
        raise DeviceError(f"SDL is missing ({error}); run: {REMEDY}") from error
    # Nothing here has a window that could be in front; and Ctrl-C is not SDL's.
    sdl2.SDL_SetHint(b"SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS", b"1")
    sdl2.SDL_SetHint(b"SDL_NO_SIGNAL_HANDLERS", b"1")
    parts = sdl2.SDL_INIT_JOYSTICK | sdl2.SDL_INIT_GAMECONTROLLER | sdl2.SDL_INIT_HAPTIC
    if sdl2.SDL_InitSubSystem(parts) != 0:
        raise DeviceError(
            f"SDL cannot start ({sdl2.SDL_GetError().decode(errors='replace')}); reinstall: {REMEDY}"
        )
    sdl2.SDL_JoystickEventState(sdl2.SDL_IGNORE)
    sdl2.SDL_GameControllerEventState(sdl2.SDL_IGNORE)
    return sdl2


def _find(address: str) -> tuple[int, Identity]:
    update()
    there: list[Identity] = []
    for index in range(sdl().SDL_NumJoysticks()):
        identity = _identity(index)
        if identity and identity.known_as(address):
            return index, identity
        if identity:
            there.append(identity)
    if not there:
        raise DeviceError("No joystick or gamepad is connected; plug one in, see `groundstation devices`.")
    others = ", ".join(f"{identity.name} ({identity.guid})" for identity in there)
    raise DeviceError(f"{address}: no joystick is known by this; connected: {others}.")


def _identity(index: int) -> Identity | None:
    """Return who it is; its serial number is told only while it is open."""
    import ctypes

    library = sdl()
    handle = library.SDL_JoystickOpen(index)
    if not handle:
        return None
    try:
        digits = ctypes.create_string_buffer(33)
        library.SDL_JoystickGetGUIDString(library.SDL_JoystickGetGUID(handle), digits, 33)
        texts = (
            digits.value,
            library.SDL_JoystickGetSerial(handle),
            library.SDL_JoystickName(handle),
            library.SDL_JoystickPath(handle),
        )
        return Identity(*((text or b"").decode(errors="replace") for text in texts))
    finally:
        library.SDL_JoystickClose(handle)
