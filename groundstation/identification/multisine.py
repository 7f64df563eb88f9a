"""Multisines: sums of sines on chosen lines, with little crest, for telling a response apart.

    x(t) = Σ b_k sin(2π f_k t + φ_k),        f_k = n_k / T

What is made is a *way*, x, and the velocity is its derivative: so the way is bounded by construction, and over a
period T the velocity has no mean. The velocities of all lines are alike, b_k = a / 2π f_k; phases are Schroeder's or,
where they have less crest, the best of many random ones (Schroeder 1970, Synthesis of low-peak-factor signals and
binary sequences with low autocorrelation; Pintelon and Schoukens 2012, System Identification: A Frequency Domain
Approach, ch. 5).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Numbers = npt.NDArray[np.float64]

# Phases that are tried.
_DRAWS = 300
# Samples a period of the fastest line, at which peaks are looked for.
_FINENESS = 24


class Peaks(NamedTuple):
    """Bounds of a signal: way, m or rad; and its first three derivatives."""

    way: float
    velocity: float
    acceleration: float
    jerk: float


class Multisine(NamedTuple):
    """A sum of sines.

    Attributes:
        period: T, s.
        lines: (k,), n_k, multiples of 1 / T.
        amplitudes: (k,), b_k, of the way, m or rad.
        phases: (k,), φ_k, rad.
    """

    period: float
    lines: npt.NDArray[np.int64]
    amplitudes: Numbers
    phases: Numbers

    @property
    def frequencies(self) -> Numbers:
        """Return f_k, Hz."""
        return self.lines / self.period

    def scaled(self, share: float) -> Multisine:
        """Return the same with other amplitudes."""
        return self._replace(amplitudes=self.amplitudes * share)

    def at(self, t: float) -> tuple[float, float]:
        """Return way and velocity at a time, s."""
        omega = math.tau * self.frequencies
        angle = omega * t + self.phases
        return float(self.amplitudes @ np.sin(angle)), float((self.amplitudes * omega) @ np.cos(angle))

    def peaks(self) -> Peaks:
        """Return what way, velocity, acceleration and jerk are never beyond.

        Between samples a trigonometric polynomial of degree n on N > 2 n points is no more than its largest sample
        divided by cos(π n / N) (Ehlich and Zeller 1964, Schwankung von Polynomen zwischen Gitterpunkten).
        """
        samples = _FINENESS * int(self.lines.max())
        t = np.arange(samples) * (self.period / samples)
        omega = math.tau * self.frequencies
        angles = np.outer(t, omega) + self.phases
        sines, cosines = np.sin(angles), np.cos(angles)
        found = [
            np.abs(wave @ (self.amplitudes * omega**order)).max()
            for order, wave in enumerate((sines, cosines, sines, cosines))
        ]
        between = math.cos(math.pi / _FINENESS)
        way, velocity, acceleration, jerk = (float(peak) / between for peak in found)
        return Peaks(way, velocity, acceleration, jerk)


def lines_within(low: float, high: float, period: float) -> range:
    """Return the multiples of 1 / period, s, that lie within a band, Hz."""
    return range(max(1, math.ceil(low * period - 1e-9)), math.floor(high * period + 1e-9) + 1)


def multisine(lines: Sequence[int], period: float, seed: int) -> Multisine:
    """Return a multisine whose velocity has a peak of 1.

    Args:
        lines: n_k, one at least, all different and above 0.
        period: T, s.
        seed: Of the random phases.
    """
    numbers = np.array(sorted(lines), dtype=np.int64)
    amplitudes: Numbers = np.asarray(period / (math.tau * numbers), dtype=np.float64)
    count = len(numbers)
    k = np.arange(count)
    tried = np.vstack(
        (-math.pi * k * (k + 1) / count, np.random.default_rng(seed).uniform(0.0, math.tau, (_DRAWS, count)))
    )
    samples = 8 * int(numbers.max())
    angles = np.outer(numbers, np.arange(samples) * (math.tau / samples))
    # |Σ cos(angle + φ)| of all draws at once: the real part of e^(iφ) e^(i angle).
    peaks = np.abs(np.real(np.exp(1j * tried) @ np.exp(1j * angles))).max(axis=1)
    best = Multisine(period, numbers, amplitudes, tried[int(peaks.argmin())])
    return best.scaled(1.0 / best.peaks().velocity)
