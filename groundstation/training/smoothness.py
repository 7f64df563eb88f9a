"""How smooth a motion is: the spectral arc length of its speed (SPARC).

S. Balasubramanian, A. Melendez-Calderon, A. Roby-Brami, E. Burdet: On the analysis of movement smoothness, Journal of
NeuroEngineering and Rehabilitation 12:112, 2015; the constants are theirs. It does not depend on how fast or how long
a motion is, only on its shape: a speed that rises and falls once is smooth, one that falters is not.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

Numbers = npt.NDArray[np.float64]

RATE_HZ = 50.0
# Beyond this frequency nothing is looked at, Hz; nor beyond the last at which the spectrum reaches this share of
# what it has at zero.
CUT_OFF_HZ = 10.0
THRESHOLD = 0.05
# The spectrum is drawn this many times finer than the motion's length gives it, as a power of two.
_FINER = 4
# A shorter stretch of motion has no shape worth telling, s; a longer one is judged in parts, each in milliseconds.
SHORTEST_S, LONGEST_S = 1.0, 300.0


def spectral_arc_length(speed: Numbers, rate_hz: float = RATE_HZ) -> float:
    """Return the spectral arc length of a motion, at most −1 or a little below: nearer to 0 is smoother.

    −∫ √((1/ω_c)² + (dV̂/dω)²) dω from 0 to ω_c, where V̂ is the spectrum of the speed over its value at zero.

    Args:
        speed: (n,), m/s, sampled evenly.
        rate_hz: How often.

    Returns:
        NaN where nothing moved, or not all of it is known.
    """
    total = float(np.sum(speed)) if len(speed) else 0.0
    if not math.isfinite(total) or total <= 0.0:
        return math.nan
    points = 2 ** (math.ceil(math.log2(len(speed))) + _FINER)
    spectrum = np.abs(np.fft.rfft(speed, points)) / total
    frequency = np.arange(len(spectrum)) * (rate_hz / points)
    spectrum = spectrum[frequency <= CUT_OFF_HZ]
    last = int(np.flatnonzero(spectrum >= THRESHOLD)[-1])
    if last == 0:
        return math.nan
    steps = np.diff(spectrum[: last + 1])
    return -float(np.sum(np.hypot(1.0 / last, steps)))


class Smoothness:
    """The smoothness of a flight as it comes: the mean of its stretches', each weighted by how long it lasted.

    A stretch ends where rows lie further apart than `gap_s`, and after `LONGEST_S`: so neither what is kept of it nor
    what it takes to judge it grows with the flight.

    Args:
        gap_s: Rows of one stretch of motion lie no further apart, s.
    """

    def __init__(self, gap_s: float) -> None:
        self._gap_s = gap_s
        self._t, self._speed = array("d"), array("d")
        self._weight = self._total = 0.0

    def add(self, t: float, speed: float) -> None:
        """Take in a row: time (s, ascending) and speed (m/s), however often they come."""
        if self._t and (t - self._t[-1] > self._gap_s or t - self._t[0] > LONGEST_S):
            self._weight, self._total = self._with_the_last()
            self._t, self._speed = array("d"), array("d")
        self._t.append(t)
        self._speed.append(speed)

    def value(self) -> float:
        """Return it up to now; NaN where no stretch was long enough."""
        weight, total = self._with_the_last()
        return total / weight if weight else math.nan

    def _with_the_last(self) -> tuple[float, float]:
        """Return the sum of weights and of weighted lengths, with the stretch that is not ended yet."""
        lasted = self._t[-1] - self._t[0] if self._t else 0.0
        length = spectral_arc_length(evenly(self._t, self._speed)) if lasted >= SHORTEST_S else math.nan
        if not math.isfinite(length):
            return self._weight, self._total
        return self._weight + lasted, self._total + lasted * length


def evenly(t: Sequence[float], speed: Sequence[float]) -> Numbers:
    """Return the speeds of a stretch at even times, `RATE_HZ`, on straight lines between those that are known."""
    since = np.array(t, np.float64) - t[0]
    return np.interp(np.arange(0.0, since[-1], 1.0 / RATE_HZ), since, np.array(speed, np.float64))


def parted(rows: list[tuple[float, float]], gap_s: float) -> list[list[tuple[float, float]]]:
    """Part rows of time and speed into stretches wherever more than `gap_s` lies between two."""
    if not rows:
        return []
    stretches = [[rows[0]]]
    for before, row in pairwise(rows):
        if row[0] - before[0] > gap_s:
            stretches.append([])
        stretches[-1].append(row)
    return stretches
