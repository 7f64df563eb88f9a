"""A gamepad that SDL takes for real: its virtual joystick, moved by a hand.

SDL's virtual joysticks live in the process that makes them. So this one is not run beside the program like the
others; it is a driver of its own, `virtual-joystick:SOCKET`: the hand's intention comes by datagrams, goes into SDL
as axes and buttons, and comes out through the joystick's driver; rumble goes the other way.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Sequence

from drivers.device import ZERO3, DeviceInfo, HandleState, Vector3
from drivers.emulators.hand import EmulatedHand
from drivers.joystick import sticks
from drivers.joystick.driver import FULL_YAW, WORKSPACE, Joystick
from drivers.joystick.sdl import sdl

NAME = "Virtual gamepad"
_VENDOR, _PRODUCT = 0x6773, 0x0001
_AXES, _BUTTONS = 6, 11
_RELEASED = -32768
_MODE = 2


class JoystickEmulator:
    """A virtual gamepad with rumble and a hand on it.

    Args:
        hand: Whose hand; rumble does not move it.
        clock: Monotonic seconds.

    Attributes:
        rumble: What its motors were last told, low and high frequency, 0 to 65535.
    """

    WORKSPACE = WORKSPACE

    def __init__(self, hand: EmulatedHand, clock: Callable[[], float]) -> None:
        self._hand = hand
        self._clock = clock
        self._sources = sticks.gamepad(_MODE)
        self._attached = False
        self.rumble = (0, 0)
        self.plug()

    @property
    def uri(self) -> str:
        """What to give to `--device`, in this process."""
        return f"joystick:{NAME}"

    def descriptors(self) -> Sequence[int]:
        """Return none: nothing becomes readable."""
        return ()

    def turn(self) -> None:
        """Move the hand, and the sticks with it."""
        state = self._hand.step(self._clock(), ZERO3)
        if not self._attached:
            return
        library = sdl()
        shares = (*(part / WORKSPACE for part in state.position), state.yaw / FULL_YAW)
        for source, share in zip(self._sources, shares, strict=True):
            if source is not None:
                value = round(sticks.FULL * max(-1.0, min(1.0, share)) * source.sign)
                library.SDL_JoystickSetVirtualAxis(self._handle, source.axis, value)
        for button in range(_BUTTONS):
            library.SDL_JoystickSetVirtualButton(self._handle, button, state.buttons >> button & 1)

    def plug(self) -> None:
        """Put it in, if it is out."""
        if self._attached:
            return
        library = sdl()
        description = library.SDL_VirtualJoystickDesc()
        description.version = library.SDL_VIRTUAL_JOYSTICK_DESC_VERSION
        description.type = library.SDL_JOYSTICK_TYPE_GAMECONTROLLER
        description.naxes, description.nbuttons = _AXES, _BUTTONS
        description.vendor_id, description.product_id = _VENDOR, _PRODUCT
        description.name = NAME.encode()
        # SDL calls it as long as the joystick lives, so it is kept.
        self._shaken = type(description.Rumble)(self._shake)
        description.Rumble = self._shaken
        index = library.SDL_JoystickAttachVirtualEx(ctypes.byref(description))
        self._handle = library.SDL_JoystickOpen(index)
        for trigger in (4, 5):
            library.SDL_JoystickSetVirtualAxis(self._handle, trigger, _RELEASED)
        self._attached = True

    def unplug(self) -> None:
        """Pull it out, if it is in."""
        if not self._attached:
            return
        library = sdl()
        number = library.SDL_JoystickInstanceID(self._handle)
        for index in range(library.SDL_NumJoysticks()):
            if library.SDL_JoystickGetDeviceInstanceID(index) == number:
                library.SDL_JoystickDetachVirtual(index)
                break
        library.SDL_JoystickClose(self._handle)
        self._attached = False

    def close(self) -> None:
        """Unplug it for good and let the hand go."""
        self.unplug()
        self._hand.close()

    def _shake(self, _data: object, low: int, high: int) -> int:
        self.rumble = (low, high)
        return 0


class VirtualJoystick:
    """The virtual gamepad and the joystick's driver on it, as one device.

    Args:
        address: Path of the socket its hand listens on; see `drivers.stick`.
        clock: Monotonic seconds.
        mode: See `drivers.joystick.driver.Joystick`.
    """

    def __init__(
        self, address: str, clock: Callable[[], float] = time.monotonic, *, mode: object = 2
    ) -> None:
        self._address = address
        self._clock = clock
        self._emulator: JoystickEmulator | None = None
        self._joystick = Joystick(NAME, clock, mode=mode)

    @property
    def info(self) -> DeviceInfo:
        """What the joystick's driver says of it."""
        return self._joystick.info

    def open(self) -> None:
        """Plug it in, and open it as any other."""
        self.close()
        self._emulator = JoystickEmulator(EmulatedHand(WORKSPACE, self._clock, self._address), self._clock)
        self._joystick.open()

    def read(self) -> HandleState:
        """Let the hand move, and read the joystick."""
        if self._emulator is not None:
            self._emulator.turn()
        return self._joystick.read()

    def write_force(self, force: Vector3) -> None:
        """Render a force, N, as rumble."""
        self._joystick.write_force(force)

    def close(self) -> None:
        """Let it go and unplug it."""
        self._joystick.close()
        emulator, self._emulator = self._emulator, None
        if emulator is not None:
            emulator.close()
