"""Known wrong things that trainees do, each with its condition and what to do instead. Pure, sample by sample."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from groundstation.frames import Vector3
from groundstation.training.guide import Way
from groundstation.training.oscillation import Oscillation

# A force that can be felt, N, against a displacement that is meant, as a share of the travel.
_FELT_N, _MEANT = 0.5, 0.4
# A vehicle that is slower stands, m/s.
_STANDS = 0.15
# Time to contact is too short under this, s, at more than so many m/s (Lee 1976, A theory of visual control of
# braking based on information about time-to-collision: people brake by the time that is left).
_CONTACT_S, _FAST = 0.7, 0.6
# The ends of the travel, as a share; and of a stick that rests.
_EDGE, _FULL, _RESTING = 0.95, 0.97, 0.12
# Room or time ahead that full stick leaves too little of, m and s.
_ROOM_M, _AHEAD_S = 3.0, 2.5
_TURNING = 0.4
# What of altitude is forgotten, m.
_LEVEL_M = 0.6


class Seen(NamedTuple):
    """One moment of a coupled hand, as a coach sees it.

    Attributes:
        t: s.
        handle: Displacement along its axes, share of its travel.
        yaw: Its rotation, share of its travel, turned left positive.
        force: On the hand, along the same axes, N.
        velocity: Of the vehicle along the same axes, m/s.
        clearance: From the hull to the nearest obstacle, m; infinite where there is none.
        closing: How fast that shrinks, m/s.
        on_leash: p_h wanted to go further from the vehicle than it may.
        by_position: The handle's travel is p_h's.
        way: To the goal, or None where there is none or it has been reached.
        heading: The goal asks for a heading.
    """

    t: float
    handle: Vector3
    yaw: float
    force: Vector3
    velocity: Vector3
    clearance: float
    closing: float
    on_leash: bool
    by_position: bool
    way: Way | None
    heading: bool

    @property
    def travel(self) -> float:
        """Displacement, share of the travel."""
        return math.hypot(*self.handle)

    @property
    def speed(self) -> float:
        """Of the vehicle, m/s."""
        return math.hypot(*self.velocity)


class Habit(NamedTuple):
    """A wrong thing.

    Attributes:
        name: Of it.
        words: What to do instead.
        basic: Only beginners do it; who has got on is not told.
    """

    name: str
    words: str
    basic: bool = False


def _fights(seen: Seen) -> bool:
    against = sum(f * x for f, x in zip(seen.force, seen.handle, strict=True)) < 0.0
    return against and math.hypot(*seen.force) > _FELT_N and seen.travel > _MEANT and seen.speed < _STANDS


def _rushes(seen: Seen) -> bool:
    return seen.closing > _FAST and seen.clearance < _CONTACT_S * seen.closing


def _rams(seen: Seen) -> bool:
    """Full stick with little room, or little way left."""
    near = seen.way is not None and seen.way.distance < _AHEAD_S * seen.speed
    return not seen.by_position and seen.travel > _FULL and (seen.clearance < _ROOM_M or near)


def _turns_only(seen: Seen) -> bool:
    return abs(seen.yaw) > _TURNING and seen.travel < _RESTING and seen.way is not None and not seen.heading


def _forgets_altitude(seen: Seen) -> bool:
    way = seen.way
    if way is None or abs(seen.handle[2]) > _RESTING or abs(seen.velocity[2]) > _STANDS:
        return False
    return abs(way.up) > _LEVEL_M and math.hypot(way.ahead, way.left) < abs(way.up)


def _waits(seen: Seen) -> bool:
    return (
        seen.travel < _RESTING and abs(seen.yaw) < _RESTING and seen.speed < _STANDS and seen.way is not None
    )


OSCILLATING = Habit("oscillating", "You and the drone swing after one another: let go, then push less.")
RUSHING = Habit("rushing", "Too fast this near: ease off until you have time to stop.")
FIGHTING = Habit("fighting", "You push against the force and nothing moves: ease off, go round.")
LEASH = Habit("leash", "The drone does not keep up: ease off until the leash is short.")
EDGE = Habit("edge", "End of the handle's travel: clutch, bring it back, clutch again, reach on.")
RAMMING = Habit("ramming", "Full stick with little room: half of it leaves time to stop.", basic=True)
ALTITUDE = Habit("altitude", "You are over or under it: the altitude is what is left to do.", basic=True)
TURNING = Habit("turning", "No need to turn: it flies sideways and back as well, push there.", basic=True)
WAITING = Habit("waiting", "Nothing moves: a small push is enough, the drone follows gently.", basic=True)
# What is done for so long, s, is a habit; the more pressing first.
_SHOWN: tuple[tuple[Habit, float, Callable[[Seen], bool]], ...] = (
    (RUSHING, 0.25, _rushes),
    (FIGHTING, 1.5, _fights),
    (LEASH, 3.0, lambda seen: seen.on_leash),
    (EDGE, 0.8, lambda seen: seen.by_position and seen.travel > _EDGE),
    (RAMMING, 1.5, _rams),
    (ALTITUDE, 3.0, _forgets_altitude),
    (TURNING, 5.0, _turns_only),
    (WAITING, 8.0, _waits),
)


class Watch:
    """Says which wrong thing is done, if one is."""

    def __init__(self) -> None:
        self._since: dict[str, float] = {}
        self._axes = tuple(Oscillation() for _ in range(3))

    def clear(self) -> None:
        """The hand is not coupled: nothing it does is wrong."""
        self._since.clear()
        for axis in self._axes:
            axis.clear()

    def look(self, seen: Seen) -> list[Habit]:
        """Return what is done wrong and has been for long enough, the most pressing first."""
        swings = [
            axis.look(seen.t, handle, velocity)
            for axis, handle, velocity in zip(self._axes, seen.handle, seen.velocity, strict=True)
        ]
        found = [habit for habit, seconds, shows in _SHOWN if self._lasts(habit, seen, seconds, shows)]
        return [OSCILLATING, *found] if any(swings) else found

    def _lasts(self, habit: Habit, seen: Seen, seconds: float, shows: Callable[[Seen], bool]) -> bool:
        if not shows(seen):
            self._since.pop(habit.name, None)
            return False
        return seen.t - self._since.setdefault(habit.name, seen.t) >= seconds
