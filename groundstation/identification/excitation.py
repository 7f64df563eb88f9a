"""An excitation: what way the hand leads the vehicle, stretch after stretch, so that its response can be identified.

One axis after the other with all lines, then all axes at once, each with lines of its own. A stretch is

    x(t) = w(t) m(t),        v(t) = w m' + w' m

with m a multisine and w a window that rises from 0 to 1, stays for a whole period and falls to 0: so every stretch
begins and ends at the start, at rest, and never leads further from it than m's peak.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from groundstation import config
from groundstation.errors import InputError
from groundstation.frames import Vector4
from groundstation.identification.multisine import Multisine, Numbers, lines_within, multisine
from groundstation.identification.samples import AXES

YAW = AXES.index("yaw rate")
FADE_S = 2.0
# Between stretches: what is left of the motion dies out.
PAUSE_S = 2.0
# Of acceleration and jerk that the limits allow; the rest is the position loop's.
_OF_LIMITS = 0.7
# The stretch of all axes is so much longer, and turns so much faster.
_LONGER = 2.0
# What is foreseen: how finely, and how long after the end, s.
_STEP_S, _AFTER_S = 0.01, 5.0
# Fewer lines tell a lag and a gain of an axis not apart from a delay.
_LEAST_LINES = 3


class Stretch(NamedTuple):
    """A time in which some axes are excited.

    Attributes:
        start: Since the excitation's start, s.
        signals: Of forward, left, up, yaw; None: that axis rests.
    """

    start: float
    signals: tuple[Multisine | None, ...]

    @property
    def period(self) -> float:
        """How long the window stays open, s."""
        return max(signal.period for signal in self.signals if signal)

    @property
    def end(self) -> float:
        """When it ends, s."""
        return self.start + self.period + 2.0 * FADE_S


class Excitation(NamedTuple):
    """Stretches in their order."""

    stretches: tuple[Stretch, ...]

    @property
    def duration(self) -> float:
        """Of all, with the pauses between, s."""
        return self.stretches[-1].end

    def at(self, t: float) -> tuple[Vector4, Vector4]:
        """Return way and velocity at a time, s: on the axes the vehicle has at the start; m, rad and a second."""
        for stretch in self.stretches:
            if stretch.start < t < stretch.end:
                return _windowed(stretch, t - stretch.start)
        return (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)

    def furthest(self) -> Vector4:
        """Return how far p_h is ever led from the start on each axis, m and rad."""
        forward, left, up, yaw = (self._peak(place, "way") for place in range(4))
        return forward, left, up, yaw

    def fastest(self) -> Vector4:
        """Return how fast p_h is ever led on each axis, m/s and rad/s: w is 1, or its slope counts."""
        slope = 0.5 * math.pi / FADE_S
        way = self.furthest()
        forward, left, up, yaw = (self._peak(place, "velocity") + slope * way[place] for place in range(4))
        return forward, left, up, yaw

    def _peak(self, place: int, name: str) -> float:
        signals = [stretch.signals[place] for stretch in self.stretches]
        return max((getattr(signal.peaks(), name) for signal in signals if signal), default=0.0)


def plan(
    axes: Sequence[int], share: float, seconds: float, band: tuple[float, float], settings: config.Settings
) -> Excitation:
    """Plan an excitation within the settings' limits.

    Args:
        axes: Which, by their places in forward, left, up, yaw.
        share: Of the handle's full speed on each axis that the velocity's peak is, 0 to 1.
        seconds: How long the stretch of an axis lasts, without its fades; that of all together twice as long.
        band: Lowest and highest frequency, Hz.
        settings: Speeds and limits.

    Raises:
        InputError: The band has too few lines.
    """
    groups = [(axis,) for axis in axes] + ([tuple(axes)] if len(axes) > 1 else [])
    stretches: list[Stretch] = []
    start = 0.0
    for number, group in enumerate(groups):
        period = seconds if len(group) == 1 else _LONGER * seconds
        lines = lines_within(*band, period)
        if len(lines) < _LEAST_LINES * len(group):
            raise InputError(
                f"--band {band[0]:g},{band[1]:g}: has {len(lines)} lines in {period:g} s, and "
                f"{_LEAST_LINES} an axis are needed; widen it, or raise --seconds."
            )
        # At once, the handle goes no further than its workspace, and the plane no faster than as a whole; the yaw is
        # apart, and the faster the better: only while it turns does a vehicle show χ₁₁ and χ₁₃.
        part = share / math.sqrt(max(1, sum(axis != YAW for axis in group)))
        turn = share if len(group) == 1 else min(1.0, _LONGER * share)
        found: list[Multisine | None] = [None] * 4
        for place, axis in enumerate(group):
            signal = multisine(lines[place :: len(group)], period, seed=4 * number + axis)
            found[axis] = _bounded(signal, axis, turn if axis == YAW else part, settings)
        stretches.append(Stretch(start, tuple(found)))
        start = stretches[-1].end + PAUSE_S
    return Excitation(tuple(stretches))


class Foreseen(NamedTuple):
    """How a vehicle will follow, a row every 10 ms; of several responses the worst.

    Attributes:
        distance: (n, 2), from the start, level and up or down, m.
        speed: (n, 2), that is asked of it, likewise, m/s.
    """

    distance: Numbers
    speed: Numbers


def foreseen(
    excitation: Excitation, responses: Sequence[tuple[float, float]], k1: float, delay: float
) -> Foreseen:
    """Return how the vehicle itself will move in still air; the yaw is left out.

    The position loop leads it along p_h: ẋ = v, τ v̇ = g u(t − d) − v with u = v_h + K₁ tanh(x_h − x).

    Args:
        excitation: What is flown.
        responses: Gain at rest g and time constant τ, s, that it may have.
        k1: 1/s.
        delay: d, s.
    """
    times = np.arange(0.0, excitation.duration + _AFTER_S, _STEP_S)
    asked = np.array([excitation.at(float(t)) for t in times])[:, :, :3]
    gains, lags = np.array(responses).T[:, :, None]
    x = np.zeros((len(responses), 3))
    v = np.zeros_like(x)
    late = [x] * (1 + round(delay / _STEP_S))
    distance, speed = np.empty((len(times), 2)), np.empty((len(times), 2))
    for row, (way, velocity) in enumerate(asked):
        wanted = velocity + k1 * np.tanh(way - x)
        late.append(wanted)
        v = v + (gains * late.pop(0) - v) * (_STEP_S / lags)
        x = x + v * _STEP_S
        distance[row], speed[row] = _level_and_upright(x), _level_and_upright(wanted)
    return Foreseen(distance, speed)


def _level_and_upright(vectors: Numbers) -> tuple[float, float]:
    """Return the largest length in the plane, and along the vertical, of (n, 3)."""
    return float(np.hypot(vectors[:, 0], vectors[:, 1]).max()), float(np.abs(vectors[:, 2]).max())


def _bounded(signal: Multisine, axis: int, share: float, settings: config.Settings) -> Multisine:
    """Return a multisine of velocity peak 1 scaled to a share of the axis's speed, or less by the limits."""
    limits = settings.limits
    by_axis = (limits.horizontal_speed, limits.horizontal_speed, limits.vertical_speed, limits.yaw_rate)
    acceleration, jerk = limits.acceleration, limits.jerk
    if axis == YAW:
        acceleration, jerk = limits.yaw_acceleration, limits.yaw_jerk
    peaks = signal.peaks()
    speed = min(settings.mapping.speed[axis], by_axis[axis])
    return signal.scaled(
        min(
            share * speed / peaks.velocity,
            _OF_LIMITS * acceleration / peaks.acceleration,
            _OF_LIMITS * jerk / peaks.jerk,
        )
    )


def _windowed(stretch: Stretch, t: float) -> tuple[Vector4, Vector4]:
    """Return way and velocity at a time within a stretch, s."""
    window, slope = _window(t, stretch.period)
    pairs = [signal.at(t - FADE_S) if signal else (0.0, 0.0) for signal in stretch.signals]
    a, b, c, d = (window * way for way, _ in pairs)
    e, f, g, h = (window * velocity + slope * way for way, velocity in pairs)
    return (a, b, c, d), (e, f, g, h)


def _window(t: float, period: float) -> tuple[float, float]:
    """Return w and w' of a window sin² that is open for a period, 1/s."""
    left = min(t, period + 2.0 * FADE_S - t)
    if left >= FADE_S:
        return 1.0, 0.0
    angle = 0.5 * math.pi * max(left, 0.0) / FADE_S
    slope = 0.5 * math.pi / FADE_S * math.sin(2.0 * angle)
    return math.sin(angle) ** 2, slope if t < FADE_S else -slope
