"""Velocity of what is only known in steps now and then: a low-passed difference.

    v ← v + (1 − e^(−dt/τ)) ((x − x') / dt − v)

For sticks and caps whose reports come at 60-250 Hz: the window of `drivers.velocity` would take each report for a
jump between two rests.
"""

from __future__ import annotations

import math

from drivers.device import ZERO3, Vector3

TIME_CONSTANT_S = 0.05


class Smooth:
    """Three axes.

    Attributes:
        velocity: As of the newest sample, m/s.
    """

    def __init__(self) -> None:
        self._t = -math.inf
        self._place = ZERO3
        self.velocity = ZERO3

    def add(self, t: float, place: Vector3) -> None:
        """Take where it is, m, at `t`, s. After a gap, as at first, it is taken to have been at rest."""
        elapsed = t - self._t
        if elapsed <= 0.0:
            return
        if elapsed > 4.0 * TIME_CONSTANT_S:
            self.velocity = ZERO3
        else:
            share = -math.expm1(-elapsed / TIME_CONSTANT_S)
            gain = share / elapsed
            (x, y, z), (a, b, c), (u, v, w) = place, self._place, self.velocity
            self.velocity = (
                u + gain * (x - a) - share * u,
                v + gain * (y - b) - share * v,
                w + gain * (z - c) - share * w,
            )
        self._t, self._place = t, place
