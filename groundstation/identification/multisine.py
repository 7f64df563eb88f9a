"""What is flown to be identified from: sums of sines, axis by axis, then all axes at once.

Phases are Schroeder's (1970, Synthesis of low-peak-factor signals and binary sequences with low autocorrelation):
they keep the peak of a sum of sines low. Every sine has whole periods in its stretch, so it ends where it began.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Numbers = npt.NDArray[np.float64]

AXES = 4
# Of an axis flown alone, Hz: from far below to above what a multirotor's velocity follows.
LOWEST_HZ, HIGHEST_HZ = 0.08, 1.0
_LINES = 8
# A stretch begins and ends softly, s.
FADE_S = 1.0
_GRID_S = 0.01


class Stretch(NamedTuple):
    """A time in which some axes are excited.

    Attributes:
        start, end: s.
        lines: (4, k), frequencies by axis, Hz; 0 where an axis has no such line.
        phases: (4, k), rad.
        amplitude: (4,), of each sine, m/s and rad/s; 0 where the axis rests.
    """

    start: float
    end: float
    lines: Numbers
    phases: Numbers
    amplitude: Numbers


class Excitation(NamedTuple):
    """All stretches, one behind the other."""

    stretches: tuple[Stretch, ...]

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return self.stretches[-1].end

    def at(self, t: float) -> tuple[float, float, float, float]:
        """Return velocities on the vehicle's axes at a time, m/s and rad/s; zero before and after."""
        for stretch in self.stretches:
            if stretch.start <= t < stretch.end:
                forward, left, up, yaw_rate = _velocities(stretch, np.array([t]))[0]
                return float(forward), float(left), float(up), float(yaw_rate)
        return 0.0, 0.0, 0.0, 0.0

    def sampled(self) -> tuple[Numbers, Numbers]:
        """Return times, (n,), s, and velocities, (n, 4), on a fine grid."""
        times = [np.arange(each.start, each.end, _GRID_S) for each in self.stretches]
        velocities = [_velocities(each, t) for each, t in zip(self.stretches, times, strict=True)]
        return np.concatenate(times), np.concatenate(velocities)

    def excursion(self) -> Numbers:
        """Return how far each axis gets from the start, (4,), m and rad, were the vehicle to do what is asked."""
        _, velocities = self.sampled()
        return np.abs(np.cumsum(velocities, axis=0) * _GRID_S).max(axis=0)


def excitation(peaks: Sequence[float], seconds: float, axes: Sequence[int]) -> Excitation:
    """Return the excitation of some axes: each alone, then all of them at once.

    Args:
        peaks: (4,), largest velocity of each axis, m/s and rad/s.
        seconds: Of a stretch; the one with all axes is twice as long.
        axes: Which, 0 to 3.
    """
    stretches: list[Stretch] = []
    start = 0.0
    for axis in axes:
        stretches.append(_stretch(start, seconds, [axis], peaks))
        start += seconds
    if len(axes) > 1:
        stretches.append(_stretch(start, 2.0 * seconds, axes, peaks))
    return Excitation(tuple(stretches))


def _stretch(start: float, seconds: float, axes: Sequence[int], peaks: Sequence[float]) -> Stretch:
    """Return a stretch in which every axis has lines of its own, so that their answers can be told apart."""
    periods = np.unique(np.rint(np.geomspace(LOWEST_HZ, HIGHEST_HZ, _LINES * len(axes)) * seconds)).astype(
        np.float64
    )
    # Where lines are few the same number of periods would come twice: then there are fewer lines.
    count = max(1, len(periods) // len(axes))
    lines, phases = np.zeros((AXES, count)), np.zeros((AXES, count))
    amplitude = np.zeros(AXES)
    number = np.arange(count)
    for place, axis in enumerate(axes):
        lines[axis] = periods[place :: len(axes)][:count] / seconds
        phases[axis] = -np.pi * number * (number + 1) / count
        amplitude[axis] = 1.0
    unscaled = Stretch(start, start + seconds, lines, phases, amplitude)
    largest = np.abs(_velocities(unscaled, np.arange(start, start + seconds, _GRID_S))).max(axis=0)
    scale = np.divide(np.asarray(peaks, np.float64), largest, out=np.zeros(AXES), where=largest > 0.0)
    return unscaled._replace(amplitude=amplitude * scale)


def _velocities(stretch: Stretch, t: Numbers) -> Numbers:
    """Return velocities within a stretch, (n, 4)."""
    since = t - stretch.start
    turns = 2.0 * np.pi * since[:, None, None] * stretch.lines + stretch.phases
    active = stretch.lines > 0.0
    sines = np.where(active, np.sin(turns), 0.0).sum(axis=2)
    fade = np.clip(np.minimum(since, stretch.end - t) / FADE_S, 0.0, 1.0)
    return sines * stretch.amplitude * fade[:, None]
