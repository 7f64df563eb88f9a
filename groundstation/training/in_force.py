"""What of all that was let happen to a flight is in force at a moment."""

from __future__ import annotations

import math
from typing import NamedTuple

from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)
from groundstation.training.happening import Calm, Happening, words

NOTHING = "nothing"
# A lane's word for each, the gravest first: what is in force besides it is told by the events.
STATES: dict[type[Happening], str] = {
    LinkLoss: "link lost",
    DeviceLoss: "device lost",
    GpsLoss: "GPS lost",
    GustNow: "gust",
    BatteryLeft: "battery",
    Delay: "delay",
    Loss: "frames lost",
    WindChange: "wind",
}
# How long a charge that was taken away counts as happening, s.
_CHARGE_S = 5.0


class _Done(NamedTuple):
    """What was done, from when until when it is in force, s."""

    happening: Happening
    begins: float
    ends: float


class InForce:
    """Takes note of what was done; that of one kind must come in the order of time."""

    def __init__(self) -> None:
        self._done: dict[type[Happening], _Done] = {}
        self._taken_back_t = -math.inf

    def take(self, happening: Happening, t: float) -> None:
        """Take note of something done at `t`, s; what is of its kind it replaces."""
        if isinstance(happening, Calm):
            self._taken_back_t = max(self._taken_back_t, t)
        else:
            self._done[type(happening)] = _Done(happening, t, _end(happening, t))

    def at(self, t: float) -> list[Happening]:
        """Return what is in force at a time, s, the gravest first."""
        return [done.happening for done in self._at(t)]

    def state(self, t: float) -> str:
        """Return a lane's word for it."""
        found = self.at(t)
        return STATES[type(found[0])] if found else NOTHING

    def told(self, t: float) -> str:
        """Return all of it in words."""
        return "; ".join(f"{words(done.happening)}{_left(done, t)}" for done in self._at(t)) or NOTHING

    def _at(self, t: float) -> list[_Done]:
        known = [self._done[kind] for kind in STATES if kind in self._done]
        return [done for done in known if done.begins > self._taken_back_t and t < done.ends]


def _left(done: _Done, t: float) -> str:
    lasts = isinstance(done.happening, LinkLoss | DeviceLoss | GpsLoss | GustNow)
    return f" ({done.ends - t:.0f} s left)" if lasts else ""


def _end(happening: Happening, t: float) -> float:
    """Return until when something done at `t` is in force, s."""
    match happening:
        case GustNow() | LinkLoss() | DeviceLoss() | GpsLoss():
            return t + happening.duration_s
        case BatteryLeft():
            return t + _CHARGE_S
        case WindChange(velocity=(0.0, 0.0, 0.0), turbulence=0.0):
            return t
        case Delay(round_trip_s=0.0, jitter_s=0.0) | Loss(share=0.0):
            return t
        case _:
            return math.inf
