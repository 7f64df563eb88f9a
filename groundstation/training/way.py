"""How far a vehicle is from the way that a mission leads along."""

from __future__ import annotations

import math
from collections.abc import Sequence

from groundstation.frames import Vector3
from groundstation.training.mission import Mission


def way_of(mission: Mission) -> tuple[Vector3, ...]:
    """Return the points of the whole way: from above the start over the route and the target down to the pad."""
    pad = mission.landing_pad
    return (*mission.path, pad.position) if pad else mission.path


def off_the_way(way: Sequence[Vector3], leg: int, position: Vector3) -> float:
    """Return how far a place is from the way as it is flown: from the leg under way or the one before it, m.

    Only these two: where a way crosses itself, the other branch is no excuse.

    Args:
        way: The points of the way, world, m.
        leg: Which leg is under way: from point `leg` to the next; beyond the last it is the last.
        position: World, m.

    Returns:
        NaN where the way has no legs.
    """
    last = len(way) - 2
    if last < 0:
        return math.nan
    now = min(leg, last)
    return min(_from_segment(way[each], way[each + 1], position) for each in range(max(now - 1, 0), now + 1))


def _from_segment(a: Vector3, b: Vector3, p: Vector3) -> float:
    """Return the distance of p from the straight line between a and b, m."""
    along = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    square = along[0] ** 2 + along[1] ** 2 + along[2] ** 2
    dot = sum((p[axis] - a[axis]) * along[axis] for axis in range(3))
    share = min(max(dot / square, 0.0), 1.0) if square else 0.0
    return math.dist(p, (a[0] + share * along[0], a[1] + share * along[1], a[2] + share * along[2]))
