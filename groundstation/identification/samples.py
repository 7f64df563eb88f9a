"""What identification is fed with: references and velocities of a flight on one uniform grid."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from groundstation.errors import InputError

Numbers = npt.NDArray[np.float64]

AXES = ("forward", "left", "up", "yaw rate")
UNITS = ("m/s", "m/s", "m/s", "rad/s")
# Shorter than this tells nothing about a response of half a second, s.
SHORTEST_S = 5.0
# A gap in the velocities, or in the references, that is no longer than this is bridged, s.
_BRIDGED_S = 0.25
# Of a grid, s: finer tells no more of a response of half a second, coarser is too coarse to integrate.
_FINEST_S, _COARSEST_S = 0.01, 0.05
# An axis whose velocity or reference varies less than this (its standard deviation) tells nothing, m/s or rad/s.
STILL = 0.03


class Raw(NamedTuple):
    """A flight as its source tells it: n velocities and m references, each at their own times.

    Attributes:
        t: (n,), s, ascending.
        v: (n, 4), velocity on the vehicle's axes [forward, left, up, yaw rate], m/s and rad/s; NaN is not known.
        yaw: (n,), rad, world.
        sent: (m,), s, ascending: when the references took over from those before.
        ref: (m, 4), on the vehicle's axes; NaN from where on nothing is asked.
        damaged: A part of the file could not be read.
    """

    t: Numbers
    v: Numbers
    yaw: Numbers
    sent: Numbers
    ref: Numbers
    damaged: bool = False


class Stretch(NamedTuple):
    """A part of a flight in which all is known, k samples at equal distances.

    Attributes:
        v: (k, 4), velocities.
        ref: (k, 4), mean of what was asked from a sample to the next.
        yaw: (k,), rad, not wrapped.
    """

    v: Numbers
    ref: Numbers
    yaw: Numbers


class Samples(NamedTuple):
    """The stretches of a flight that tell something, on a grid with the same step.

    Attributes:
        name: Of the flight.
        dt: Step of the grid, s.
        stretches: What is known.
        left_out: Seconds in which references were sent that are not in them.
    """

    name: str
    dt: float
    stretches: tuple[Stretch, ...]
    left_out: float

    @property
    def seconds(self) -> float:
        """How long all stretches are together."""
        return self.dt * sum(len(stretch.v) for stretch in self.stretches)


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


def held(t: Numbers, values: Numbers, at: Numbers) -> Numbers:
    """Return the rows that were in effect at given times, (k, ...); NaN before the first."""
    place = np.searchsorted(t, at, side="right") - 1
    rows = values[np.maximum(place, 0)].astype(np.float64)
    rows[place < 0] = np.nan
    return rows


def step_of(name: str, raw: Raw) -> float:
    """Return the step that suits a flight, s: the median of its own.

    Raises:
        InputError: Its times do not ascend.
    """
    for t in (raw.t, raw.sent):
        if len(t) < 2 or not np.isfinite(t).all() or (np.diff(t) <= 0.0).any():
            raise InputError(
                f"{name}: its times do not ascend; give a flight whose t is in seconds, in order."
            )
    return float(np.clip(np.median(np.diff(raw.t)), _FINEST_S, _COARSEST_S))


def on_grid(name: str, raw: Raw, dt: float) -> Samples:
    """Return a flight on a uniform grid, cut where something is not known.

    Velocities are interpolated. References are held by the vehicle from one to the next, so of each step of the
    grid the mean over the step is taken: a response that is slower than the step knows no difference.

    Raises:
        InputError: Too little is known.
    """
    known = np.isfinite(raw.v.sum(axis=1) + raw.yaw)
    asked = np.isfinite(raw.ref.sum(axis=1))
    stretches: list[Stretch] = []
    left_out = 0.0
    for first, last in _asked_for(raw.sent, asked):
        before = sum(len(stretch.v) for stretch in stretches) * dt
        for start, end in _runs(raw.t, known & (raw.t >= first) & (raw.t <= last)):
            if (stretch := _stretch(raw, start, end, dt)) is not None:
                stretches.append(stretch)
        used = sum(len(stretch.v) for stretch in stretches) * dt - before
        left_out += max(0.0, last - first - used)
    if not stretches:
        raise InputError(
            f"{name}: has no {SHORTEST_S:g} s in a row in which references were sent and velocities known; "
            "fly longer, 'groundstation excite' does."
        )
    return Samples(name, dt, tuple(stretches), left_out)


def unexcited(flights: Sequence[Samples]) -> list[str]:
    """Return the names of the axes of which hardly anything was asked in any of the flights."""
    spreads = np.max([stretch.ref.std(axis=0) for flight in flights for stretch in flight.stretches], axis=0)
    return [axis for axis, spread in zip(AXES, spreads, strict=True) if spread < STILL]


def _asked_for(sent: Numbers, asked: npt.NDArray[np.bool_]) -> Iterator[tuple[float, float]]:
    """Yield from when to when references were in effect: to the one that ends it, or shortly after the last."""
    for start, end in _runs(sent, asked):
        ending = sent[end] if end < len(sent) else np.inf
        yield float(sent[start]), float(min(ending, sent[end - 1] + _BRIDGED_S))


def _runs(t: Numbers, known: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and past-the-last of each run of known samples without a long gap."""
    places = np.flatnonzero(known)
    if not len(places):
        return []
    cuts = np.flatnonzero(np.diff(t[places]) > _BRIDGED_S) + 1
    runs = [(int(run[0]), int(run[-1]) + 1) for run in np.split(places, cuts)]
    return [part for run in runs for part in _parted(known, *run)]


def _parted(known: npt.NDArray[np.bool_], first: int, last: int) -> Iterator[tuple[int, int]]:
    """Yield the parts of a run between samples that are there and say that nothing is known."""
    holes = np.flatnonzero(~known[first:last]) + first
    for start, end in zip([first, *(holes + 1)], [*holes, last], strict=True):
        if end > start:
            yield int(start), int(end)


def _stretch(raw: Raw, first: int, last: int, dt: float) -> Stretch | None:
    """Return the samples first to past-the-last on the grid, None where they are too short."""
    t = raw.t[first:last]
    grid = np.arange(t[0], t[-1] + 1e-9, dt)
    if len(grid) * dt < SHORTEST_S:
        return None
    v = np.column_stack([np.interp(grid, t, column) for column in raw.v[first:last].T])
    yaw = np.interp(grid, t, np.unwrap(raw.yaw[first:last]))
    return Stretch(v, _means(raw.sent, raw.ref, grid, dt), yaw)


def _means(sent: Numbers, ref: Numbers, grid: Numbers, dt: float) -> Numbers:
    """Return the mean of held references over each step of the grid, (k, 4), exactly."""
    edges = np.append(grid, grid[-1] + dt)
    inside = sent[(sent > edges[0]) & (sent < edges[-1])]
    t = np.union1d(edges, inside)
    # The step that begins with the last sample may reach beyond what was asked: the last reference goes on.
    values = held(sent, ref, t[:-1])
    for row in np.flatnonzero(~np.isfinite(values).all(axis=1)):
        values[row] = values[row - 1]
    sums = np.vstack((np.zeros(4), np.cumsum(values * np.diff(t)[:, None], axis=0)))
    return np.diff(sums[np.searchsorted(t, edges)], axis=0) / dt
