"""How smooth a motion is: the spectral arc length of its speed (SPARC).

S. Balasubramanian, A. Melendez-Calderon, A. Roby-Brami, E. Burdet: On the analysis of movement smoothness, Journal of
NeuroEngineering and Rehabilitation 12:112, 2015; the constants are theirs. It does not depend on how fast or how long
a motion is, only on its shape: a speed that rises and falls once is smooth, one that falters is not.
"""

from __future__ import annotations

import math
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
# A shorter stretch of motion has no shape worth telling, s.
SHORTEST_S = 1.0


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


def smoothness(stretches: list[list[tuple[float, float]]]) -> float:
    """Return the mean spectral arc length of stretches of motion, each weighted by how long it lasted.

    Args:
        stretches: Each a row of time (s, ascending) and speed (m/s), however they came.

    Returns:
        NaN where none is long enough.
    """
    weight = total = 0.0
    for stretch in stretches:
        lasted = stretch[-1][0] - stretch[0][0] if stretch else 0.0
        if lasted < SHORTEST_S:
            continue
        length = spectral_arc_length(evenly(stretch))
        if math.isfinite(length):
            weight += lasted
            total += lasted * length
    return total / weight if weight else math.nan


def evenly(stretch: list[tuple[float, float]]) -> Numbers:
    """Return the speeds of a stretch at even times, `RATE_HZ`, on straight lines between those that are known."""
    t, speed = np.array(stretch, np.float64).T
    return np.interp(np.arange(0.0, t[-1] - t[0], 1.0 / RATE_HZ), t - t[0], speed)


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
