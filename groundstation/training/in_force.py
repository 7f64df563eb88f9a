"""What of all that was let happen to a flight is in force at a moment."""

from __future__ import annotations

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


class InForce:
    """Takes note of what was done, in the order of time."""

    def __init__(self) -> None:
        self._done: dict[type[Happening], tuple[Happening, float]] = {}

    def take(self, happening: Happening, t: float) -> None:
        """Take note of something done at `t`, s; what is of its kind it replaces."""
        if isinstance(happening, Calm):
            self._done.clear()
        else:
            self._done[type(happening)] = (happening, _end(happening, t))

    def at(self, t: float) -> list[Happening]:
        """Return what is in force at a time, s, the gravest first."""
        return [self._done[kind][0] for kind in STATES if kind in self._done and t < self._done[kind][1]]

    def state(self, t: float) -> str:
        """Return a lane's word for it."""
        found = self.at(t)
        return STATES[type(found[0])] if found else NOTHING

    def told(self, t: float) -> str:
        """Return all of it in words."""
        told = [f"{words(each)}{self._left(each, t)}" for each in self.at(t)]
        return "; ".join(told) or NOTHING

    def _left(self, happening: Happening, t: float) -> str:
        left = self._done[type(happening)][1] - t
        lasts = isinstance(happening, LinkLoss | DeviceLoss | GpsLoss | GustNow)
        return f" ({left:.0f} s left)" if lasts else ""


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
            return float("inf")
