"""How a joystick answers the hand: constant force where it has one, else rumble, else not at all.

What was last told ends by itself after 0.15 s, and is told anew before that: a program that hangs leaves no force.
Telling costs a transfer on the bus, so less than a per cent of change waits for its turn.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, Protocol

from drivers.device import ZERO3, Vector3
from drivers.joystick.sdl import Joystick, sdl

FULL_FORCE = 10.0
"""Force, N, that is rendered with all the device has; what that is in newtons no joystick tells."""

LASTS_MS = 150
AGAIN_S = 0.05
SHORTEST_S = 0.01
WORTH_TELLING = 0.01 * FULL_FORCE

_FULL_RUMBLE = 65535
_FULL_LEVEL = 32767
_DIRECTION_SCALE = 10_000


class Push(NamedTuple):
    """A constant force as SDL wants it: where it comes from, x right, y toward the operator; and how strong."""

    from_x: int
    from_y: int
    level: int


class Renderer(Protocol):
    """What passes a force on."""

    renders: Literal["force", "rumble", "nothing"]

    def render(self, force: Vector3) -> None:
        """Render a force, N, handle frame, for 0.15 s."""
        ...

    def close(self) -> None:
        """Render nothing, and let go."""
        ...


class Nothing:
    """A joystick that cannot answer."""

    renders: Literal["force", "rumble", "nothing"] = "nothing"

    def render(self, force: Vector3) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


class Rumble:
    """Motors that shake the pad as strongly as the force is, whichever way it points."""

    renders: Literal["force", "rumble", "nothing"] = "rumble"

    def __init__(self, joystick: Joystick) -> None:
        self._handle = joystick.handle

    def render(self, force: Vector3) -> None:
        """Shake."""
        strength = round(_FULL_RUMBLE * min(1.0, math.hypot(*force) / FULL_FORCE))
        sdl().SDL_JoystickRumble(self._handle, strength, strength, LASTS_MS)

    def close(self) -> None:
        """Shake no more."""
        sdl().SDL_JoystickRumble(self._handle, 0, 0, 0)


class ConstantForce:
    """A stick that pushes in its plane.

    Args:
        haptic: SDL's handle of its motors.
        effect: Number of the effect on the device.
    """

    renders: Literal["force", "rumble", "nothing"] = "force"

    def __init__(self, haptic: Any, effect: int) -> None:  # noqa: ANN401 - pysdl2 has no types
        self._haptic = haptic
        self._effect = effect

    def render(self, force: Vector3) -> None:
        """Push."""
        library = sdl()
        library.SDL_HapticUpdateEffect(self._haptic, self._effect, ctypes.byref(effect(push(force))))
        library.SDL_HapticRunEffect(self._haptic, self._effect, 1)

    def close(self) -> None:
        """Push no more."""
        sdl().SDL_HapticStopAll(self._haptic)
        sdl().SDL_HapticClose(self._haptic)


class Sparing:
    """Passes a force on when that is worth a transfer: it changed, or what was told is about to end.

    Args:
        renderer: What renders it.
        clock: Monotonic seconds.
    """

    def __init__(self, renderer: Renderer, clock: Callable[[], float]) -> None:
        self._renderer = renderer
        self._clock = clock
        self._told = ZERO3
        self._told_t = -math.inf

    def render(self, force: Vector3) -> None:
        """Render a force, N, handle frame. To let go is told at once."""
        since = self._clock() - self._told_t
        if force == ZERO3:
            due = self._told != ZERO3
        else:
            changed = math.dist(force, self._told) >= WORTH_TELLING
            due = since >= AGAIN_S or (changed and since >= SHORTEST_S)
        if due:
            self._told, self._told_t = force, self._clock()
            self._renderer.render(force)


def push(force: Vector3) -> Push:
    """Return a force, N, handle frame, as SDL wants it; what points up or down is lost."""
    forward, left, _ = force
    strength = math.hypot(forward, left)
    if strength == 0.0:
        return Push(0, _DIRECTION_SCALE, 0)
    # Exerted to the right is −left, toward the operator −forward; it comes from the other side.
    level = round(_FULL_LEVEL * min(1.0, strength / FULL_FORCE))
    return Push(
        round(_DIRECTION_SCALE * (left / strength)), round(_DIRECTION_SCALE * (forward / strength)), level
    )


def effect(told: Push) -> Any:  # noqa: ANN401 - pysdl2 has no types
    """Return SDL's effect of a push."""
    library = sdl()
    made = library.SDL_HapticEffect()
    made.type = library.SDL_HAPTIC_CONSTANT
    made.constant.direction.type = library.SDL_HAPTIC_CARTESIAN
    made.constant.direction.dir[0] = told.from_x
    made.constant.direction.dir[1] = told.from_y
    made.constant.length = LASTS_MS
    made.constant.level = told.level
    return made


def best(joystick: Joystick) -> Renderer:
    """Return the best a joystick can do."""
    library = sdl()
    haptic = library.SDL_HapticOpenFromJoystick(joystick.handle)
    if haptic:
        if library.SDL_HapticQuery(haptic) & library.SDL_HAPTIC_CONSTANT:
            number = library.SDL_HapticNewEffect(haptic, ctypes.byref(effect(push(ZERO3))))
            if number >= 0:
                return ConstantForce(haptic, number)
        library.SDL_HapticClose(haptic)
    return Rumble(joystick) if library.SDL_JoystickHasRumble(joystick.handle) else Nothing()
