"""Oscillation that the pilot makes: hand and vehicle swing after one another, and do not settle.

A hand that corrects harder than the loop's delay and lag allow makes the loop of hand and vehicle swing (McRuer 1995,
Pilot-induced oscillations and human dynamic behavior, NASA CR-4683). The detector is after ROVER (Mitchell and
Arencibia 2004, Real-time detection of pilot-induced oscillations, AIAA 2004-4700): the swing of the handle, the swing
of the vehicle, their frequency and the lag between the two must all be what they are in such an oscillation.
"""

from __future__ import annotations

import itertools
from collections import deque
from typing import NamedTuple

# From 0.3 to 2 Hz: half a swing takes so long, s.
_SHORTEST_S, _LONGEST_S = 0.25, 1.67
# What a swing of the handle is at least, as a share of its travel, and of the vehicle, m/s.
_HANDLE, _VEHICLE = 0.3, 0.25
# So many half swings in a row make an oscillation, of which the last is at least this share of the first.
_HALVES, _LASTING = 4, 0.8
# The vehicle comes after the hand by this share of a period: 40° to 200°.
_LAG = (40.0 / 360.0, 200.0 / 360.0)
_MATCHED = 2


class Turn(NamedTuple):
    """Where a signal turned: when, s, at what value, and whether it was a peak."""

    t: float
    value: float
    peak: bool


class Turns:
    """The last turning points of a signal that swings by more than a threshold.

    Args:
        threshold: Smaller swings are none.
    """

    def __init__(self, threshold: float) -> None:
        self._threshold = threshold
        self._extreme: tuple[float, float] | None = None
        self._rising: bool | None = None
        self.turns: deque[Turn] = deque(maxlen=_HALVES + 2)

    def add(self, t: float, value: float) -> None:
        """Take a sample at `t`, s."""
        if self._extreme is None:
            self._extreme = t, value
            return
        way = value - self._extreme[1]
        if self._rising is None:
            if abs(way) >= self._threshold:
                self._rising, self._extreme = way > 0.0, (t, value)
        elif (way > 0.0) is self._rising:
            self._extreme = t, value
        elif abs(way) >= self._threshold:
            self.turns.append(Turn(*self._extreme, self._rising))
            self._rising, self._extreme = not self._rising, (t, value)

    def clear(self) -> None:
        """Forget all: the signal begins anew."""
        self._extreme = self._rising = None
        self.turns.clear()


class Oscillation:
    """Watches one axis of handle and vehicle."""

    def __init__(self) -> None:
        self._handle, self._vehicle = Turns(_HANDLE), Turns(_VEHICLE)

    def clear(self) -> None:
        """Forget all: the hand is not coupled."""
        self._handle.clear()
        self._vehicle.clear()

    def look(self, t: float, handle: float, velocity: float) -> bool:
        """Take a sample and say whether the pilot makes the vehicle oscillate.

        Args:
            t: s.
            handle: Displacement along the axis, share of its travel.
            velocity: Of the vehicle along the same axis, m/s.
        """
        self._handle.add(t, handle)
        self._vehicle.add(t, velocity)
        turns = list(self._handle.turns)[-(_HALVES + 1) :]
        if len(turns) <= _HALVES or t - turns[-1].t > _LONGEST_S:
            return False
        pairs = list(itertools.pairwise(turns))
        halves = [after.t - before.t for before, after in pairs]
        swings = [abs(after.value - before.value) for before, after in pairs]
        even = all(_SHORTEST_S <= half <= _LONGEST_S for half in halves)
        crossing = all(min(a.value, b.value) < 0.0 < max(a.value, b.value) for a, b in pairs)
        lasting = swings[-1] >= _LASTING * swings[0]
        period = 2.0 * sum(halves) / len(halves)
        return even and crossing and lasting and self._lags(turns, period)

    def _lags(self, turns: list[Turn], period: float) -> bool:
        """Say whether the vehicle turns after the hand, as late as it does in such an oscillation."""
        matched = 0
        for turn in turns[:-1]:
            same = (other.t for other in self._vehicle.turns if other.peak is turn.peak and other.t > turn.t)
            lag = (next(same, turn.t) - turn.t) / period
            matched += _LAG[0] <= lag <= _LAG[1]
        return matched >= _MATCHED
