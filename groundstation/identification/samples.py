"""What identification is fed with: references and velocities of a flight on one uniform grid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from groundstation.errors import InputError

Numbers = npt.NDArray[np.float64]

AXES = ("forward", "left", "up", "yaw rate")
UNITS = ("m/s", "m/s", "m/s", "rad/s")
# Shorter than this tells nothing about a response of half a second, s.
SHORTEST_S = 5.0
# A gap in the samples that is no longer than this is bridged, s.
_BRIDGED_S = 0.25
# An axis whose reference varies less than this (its standard deviation) was not excited, m/s or rad/s.
_EXCITED = 0.03


class Raw(NamedTuple):
    """A flight as its source tells it, n samples, not necessarily at equal distances.

    Attributes:
        t: (n,), s, ascending.
        v: (n, 4), velocity on the vehicle's axes [forward, left, up, yaw rate], m/s and rad/s.
        ref: (n, 4), what was asked for, likewise; NaN where nothing was.
    """

    t: Numbers
    v: Numbers
    ref: Numbers


class Samples(NamedTuple):
    """The longest stretches of a flight in which all is known, each on a grid with the same step.

    Attributes:
        name: Of the flight.
        dt: Step of the grid, s.
        stretches: Pairs of v and ref, each (n, 4).
    """

    name: str
    dt: float
    stretches: tuple[tuple[Numbers, Numbers], ...]

    @property
    def seconds(self) -> float:
        """How long all stretches are together."""
        return self.dt * sum(len(v) for v, _ in self.stretches)


def body_velocities(velocity: Numbers, yaw: Numbers, yaw_rate: Numbers) -> Numbers:
    """Turn world velocities onto the vehicle's axes, J⁻¹(θ) of equation (3).

    Args:
        velocity: (n, 3), world, z up, m/s.
        yaw: (n,), θ, rad, counter-clockwise from x.
        yaw_rate: (n,), rad/s.

    Returns:
        (n, 4), [forward, left, up, yaw rate].
    """
    c, s = np.cos(yaw), np.sin(yaw)
    x, y, z = velocity.T
    return np.column_stack((c * x + s * y, c * y - s * x, z, yaw_rate))


def on_grid(name: str, raw: Raw) -> Samples:
    """Return a flight on a uniform grid of its own median step, cut where something is not known.

    References are held between their samples, as the vehicle holds them; velocities are interpolated.

    Raises:
        InputError: Too little is known, time does not ascend, or nothing was asked of an axis.
    """
    if len(raw.t) < 2 or not np.isfinite(raw.t).all() or (np.diff(raw.t) <= 0.0).any():
        raise InputError(f"{name}: its times do not ascend; give a flight whose t is in seconds, in order.")
    dt = float(np.median(np.diff(raw.t)))
    known = np.isfinite(np.hstack((raw.v, raw.ref)).sum(axis=1))
    stretches: list[tuple[Numbers, Numbers]] = []
    for first, last in _runs(raw.t, known):
        t, v, ref = raw.t[first:last], raw.v[first:last], raw.ref[first:last]
        grid = np.arange(t[0], t[-1] + 0.5 * dt, dt)
        held = np.clip(np.searchsorted(t, grid + 1e-9, side="right") - 1, 0, len(t) - 1)
        v_grid = np.column_stack([np.interp(grid, t, column) for column in v.T])
        stretches.append((v_grid, ref[held]))
    samples = Samples(name, dt, tuple(each for each in stretches if len(each[0]) * dt >= SHORTEST_S))
    _check(samples)
    return samples


def _runs(t: Numbers, known: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and past-the-last of each run of known samples without a long gap."""
    places = np.flatnonzero(known)
    if not len(places):
        return []
    cuts = np.flatnonzero(np.diff(t[places]) > _BRIDGED_S) + 1
    return [(int(run[0]), int(run[-1]) + 1) for run in np.split(places, cuts)]


def _check(samples: Samples) -> None:
    if not samples.stretches:
        raise InputError(
            f"{samples.name}: has no {SHORTEST_S:g} s in a row in which references were sent and velocities known; "
            "fly longer, 'groundstation excite' does."
        )
    refs = np.concatenate([ref for _, ref in samples.stretches])
    still = [axis for axis, spread in zip(AXES, refs.std(axis=0), strict=True) if spread < _EXCITED]
    if still:
        raise InputError(
            f"{samples.name}: hardly anything was asked of {' and '.join(still)}; fly all four axes, "
            "'groundstation excite' does."
        )
