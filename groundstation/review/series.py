"""A flight on one time base, wherever it comes from: what figures and their numbers are made of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sim.environment.world import World
from sim.scenario import Obstacle

Numbers = npt.NDArray[np.float64]


class FlightSeries(NamedTuple):
    """The part of a flight in which the hand is coupled, n samples. World ENU, vehicle FLU; NaN is not known.

    Attributes:
        t: (n,), s since the hand was coupled, ascending.
        p: (n, 4), where the vehicle is, world, m and rad.
        p_h: (n, 4), where the hand wants it, likewise.
        p_h_rate: (n, 4), ṗ_h, world, m/s and rad/s.
        seen: (n, 4), p(t − d₁): where the controller saw the vehicle, world, m and rad.
        error: (n, 4), p̃ = p_h − p(t − d₁), likewise.
        v_ref: (n, 4), what the controller asks for, vehicle's axes, m/s and rad/s.
        executed: (n, 4), the velocity that the vehicle had, likewise.
        force: (n, 3), rendered on the hand, world's axes, N.
        cues: The parts it is made of by name, each (n, 3), world, N; "position" is equation (5).
        wind: (n, 3), the air's velocity at the vehicle, world, m/s.
        clearance: (n,), from the hull to the nearest obstacle, m; infinite where there is none.
        nearest: (n,), that obstacle's name, or "".
    """

    t: Numbers
    p: Numbers
    p_h: Numbers
    p_h_rate: Numbers
    seen: Numbers
    error: Numbers
    v_ref: Numbers
    executed: Numbers
    force: Numbers
    cues: Mapping[str, Numbers]
    wind: Numbers
    clearance: Numbers
    nearest: npt.NDArray[np.str_]


class Approach(NamedTuple):
    """A time in which one obstacle was near.

    Attributes:
        start, end: s.
        name: The obstacle's.
        clearance: The least in this time, m.
    """

    start: float
    end: float
    name: str
    clearance: float


def clearances(
    p: Numbers, obstacles: Sequence[Obstacle], radius: float
) -> tuple[Numbers, npt.NDArray[np.str_]]:
    """Return how far the hull is from the nearest obstacle, m, and its name, each (n,).

    Args:
        p: (n, 3 or more), world, m.
        obstacles: Of the mission.
        radius: Of the vehicle, m.
    """
    world = World(obstacles)
    found = [world.clearance((float(x), float(y), float(z))) for x, y, z in p[:, :3]]
    distance = np.array([distance for distance, _ in found], dtype=np.float64)
    return distance - radius, np.array([name for _, name in found], dtype=np.str_)


def approaches(series: FlightSeries, within: float) -> Iterator[Approach]:
    """Yield when an obstacle was nearer than `within`, m: a time for each, in their order."""
    near = np.where(series.clearance < within, series.nearest, "")
    edges = np.flatnonzero(near[1:] != near[:-1]) + 1
    for first, last in zip([0, *edges], [*edges, len(near)], strict=True):
        if last > first and near[first]:
            end = series.t[min(last, len(near) - 1)]
            least = series.clearance[first:last].min()
            yield Approach(float(series.t[first]), float(end), str(near[first]), float(least))


def lengths(vectors: Numbers) -> Numbers:
    """Return the norm of each row's first three numbers, (n,)."""
    return np.sqrt(np.square(vectors[:, :3]).sum(axis=1))


def turned(vectors: Numbers, by: Numbers) -> Numbers:
    """Turn vectors of the handle's frame into the world's, (n, 3)."""
    c, s = np.cos(by), np.sin(by)
    x, y, z = vectors.T
    return np.column_stack((c * x - s * y, s * x + c * y, z))
