"""From the axes of sticks to a handle: which axis is which, signs, and the dead zone.

SDL's axes are −32768 to 32767: left, up and pushed away are negative. The handle's are forward, left, up, and
yaw counter-clockwise from above; each −1 to 1 here.

The modes of two sticks are those of radio control:

| mode | left stick: up-down, sideways | right stick: up-down, sideways |
|---|---|---|
| 1 | forward, yaw | up, left |
| 2 | up, yaw | forward, left |
| 3 | forward, left | up, yaw |
| 4 | up, left | forward, yaw |
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple, cast

from drivers.device import DeviceError

FULL = 32767.0
DEFAULT_DEADZONE = 0.08
WIDEST_DEADZONE = 0.5

_DIRECTIONS = ("forward", "left", "up", "yaw")
_MODES = {
    1: (1, 2, 3, 0),
    2: (3, 2, 1, 0),
    3: (1, 0, 3, 2),
    4: (3, 0, 1, 2),
}


class Deflection(NamedTuple):
    """How far the sticks are out, each −1 to 1."""

    forward: float
    left: float
    up: float
    yaw: float


class Source(NamedTuple):
    """An axis by number, and the sign it counts with."""

    axis: int
    sign: float


Sources = Sequence[Source | None]
"""Where forward, left, up and yaw come from; None where there is nothing."""


def gamepad(mode: object) -> Sources:
    """Return the sources in a mode; axes 0 to 3 are left x, left y, right x, right y.

    Raises:
        DeviceError: There is no such mode.
    """
    if not isinstance(mode, int) or mode not in _MODES:
        raise DeviceError(f"devices.joystick.mode: {mode!r} is none; use 1, 2, 3 or 4.")
    return tuple(Source(axis, -1.0) for axis in _MODES[mode])


def flight_stick(axes: int) -> Sources:
    """Return the usual sources of a stick with so many axes: sideways, away, twist, throttle."""
    usual = (1, 0, 3, 2)
    return tuple(Source(axis, -1.0) if axis < axes else None for axis in usual)


def chosen(table: object) -> Sources:
    """Return the sources of the user's table, as `{forward = "-1", left = "-0"}`: sign and number of an axis.

    Raises:
        DeviceError: It is no such table.
    """
    example = 'give a table such as {forward = "-1", left = "-0", up = "-3", yaw = "-2"}'
    if not isinstance(table, Mapping) or not set(cast("Mapping[object, object]", table)) <= set(_DIRECTIONS):
        raise DeviceError(f"devices.joystick.axes: {table!r} is none; {example}.")
    sources: list[Source | None] = []
    for direction in _DIRECTIONS:
        words = str(cast("Mapping[str, object]", table).get(direction, ""))
        if words and not re.fullmatch(r"[+-]?\d{1,2}", words):
            raise DeviceError(f"devices.joystick.axes.{direction}: {words!r} is no axis; {example}.")
        sources.append(Source(abs(int(words)), -1.0 if words.startswith("-") else 1.0) if words else None)
    return sources


def deadzone(value: object) -> float:
    """Return the user's dead zone, a share of the full way.

    Raises:
        DeviceError: It is none.
    """
    if isinstance(value, (int, float)) and 0.0 <= value <= WIDEST_DEADZONE:
        return float(value)
    raise DeviceError(
        f"devices.joystick.deadzone: {value!r} is none; give a share from 0 to {WIDEST_DEADZONE}."
    )


def deflection(axes: Sequence[int], sources: Sources, zone: float) -> Deflection:
    """Return where the sticks are.

    Args:
        axes: All of the device, as SDL gives them.
        sources: Which is what.
        zone: Share of the way, around the middle, that counts as none; beyond it starts at 0 and ends at 1.
    """
    return Deflection(*(0.0 if source is None else _share(axes, source, zone) for source in sources))


def _share(axes: Sequence[int], source: Source, zone: float) -> float:
    if source.axis >= len(axes):
        return 0.0
    value = source.sign * max(-1.0, min(1.0, axes[source.axis] / FULL))
    if abs(value) <= zone:
        return 0.0
    beyond = (abs(value) - zone) / (1.0 - zone)
    return beyond if value > 0.0 else -beyond
