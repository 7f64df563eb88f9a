"""A mission out of a recorded flight: the way that was flown by hand, in few points, in the same world."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from groundstation.errors import InputError
from groundstation.recording import lanes, schema
from groundstation.review.flight import Flight, Numbers
from groundstation.review.sights import COUPLED, words_at
from groundstation.training.courses import time_for
from groundstation.training.mission import Criteria, Fence, Mission, Target, Waypoint

# Nearer to the point before than this a point tells nothing, m.
_APART_M = 0.8


def mission_from(path: Path, name: str, tolerance: float) -> Mission:
    """Return a mission that leads along the way which the hand flew.

    Args:
        path: The recording.
        name: The mission's.
        tolerance: How far the straight way may be off the one flown, m.

    Raises:
        InputError: It is no recording of a flight, or the hand has flown nowhere.
    """
    flight = Flight(path)
    world = flight.mission or Mission(schema=1, name=name, title="")
    floor = (world.fence or Fence()).floor
    way = _way_by_hand(flight)
    points = [
        (east, north, max(up, floor)) for east, north, up in np.round(thinned(way, tolerance), 1).tolist()
    ]
    points = _apart([(0.0, 0.0, world.takeoff_altitude_m), *points])[1:]
    if not points:
        raise InputError(
            f"{path}: the hand never took the vehicle anywhere; give a flight that went somewhere."
        )
    mission = replace(
        world,
        name=name,
        title=f"The way of {path.stem}",
        teaches="Fly once more the way that was flown before.",
        watch=(),
        needs=(),
        skills=world.skills or ("path",),
        route=tuple(Waypoint(point) for point in points[:-1]),
        target=Target(points[-1], radius=0.4, hold_s=2.0),
        landing=None,
        event=(),
    )
    return replace(mission, criteria=Criteria(time_limit_s=time_for(mission), final_error_m=0.3))


def thinned(way: Numbers, tolerance: float) -> Numbers:
    """Return those of a line's points that keep it within `tolerance`, m, of where it was, (k, 3).

    Source: Douglas and Peucker 1973, Algorithms for the reduction of the number of points required to represent a
    digitized line or its caricature.

    Args:
        way: (n, 3), m.
        tolerance: m.
    """
    kept = np.zeros(len(way), dtype=bool)
    kept[[0, -1]] = True
    pieces = [(0, len(way) - 1)]
    while pieces:
        first, last = pieces.pop()
        if last - first < 2:
            continue
        off = _off(way[first : last + 1])
        furthest = int(off.argmax())
        if off[furthest] > tolerance:
            kept[first + furthest] = True
            pieces += [(first, first + furthest), (first + furthest, last)]
    return way[kept]


def _off(piece: Numbers) -> Numbers:
    """Return how far the points of a piece are from the straight line between its ends, m, (n,)."""
    start, along = piece[0], piece[-1] - piece[0]
    square = float(along @ along)
    share = np.clip((piece - start) @ along / square, 0.0, 1.0) if square else np.zeros(len(piece))
    return np.linalg.norm(piece - start - share[:, None] * along, axis=1)


def _way_by_hand(flight: Flight) -> Numbers:
    """Return where the vehicle was while the hand was coupled, from its first moment to its last, (n, 3), m.

    Raises:
        InputError: It never was.
    """
    t, positions = flight.series(schema.POSITION)
    coupled = np.array([word in COUPLED for word in words_at(flight, lanes.PHASE, t)], dtype=bool)
    known = np.isfinite(positions[:, :3].sum(axis=1))
    places = np.flatnonzero(coupled & known)
    if not len(places):
        raise InputError(
            f"{flight.path}: the hand was never coupled in it; give a flight that was flown by hand."
        )
    through = slice(places[0], places[-1] + 1)
    return positions[through, :3][known[through]]


def _apart(points: list[tuple[float, float, float]]) -> list[tuple[float, float, float]]:
    """Return the points without those right beside the one before."""
    kept = points[:1]
    for point in points[1:]:
        if math.dist(point, kept[-1]) >= _APART_M:
            kept.append(point)
    return kept
