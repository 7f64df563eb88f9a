"""A ghost: where an earlier flight was at the same time since take-off. Pure."""

from __future__ import annotations

import math

from groundstation.frames import Vector3
from groundstation.training.measures import Track


def ghost_at(track: Track, elapsed: float) -> Vector3 | None:
    """Return where the ghost is, world, m: straight between the rows of its track, and where it ended after it.

    Args:
        track: Of the earlier flight.
        elapsed: Since take-off, s; before it there is no ghost.
    """
    points = track.points
    if not points or not elapsed > 0.0:
        return None
    rows = elapsed / track.every_s
    number = int(rows)
    if number + 1 >= len(points):
        return points[-1]
    (x, y, z), (a, b, c), share = points[number], points[number + 1], rows - number
    return x + share * (a - x), y + share * (b - y), z + share * (c - z)


def ghost_trail(track: Track, elapsed: float, seconds: float) -> list[Vector3]:
    """Return the way of the last `seconds`, oldest first, to where the ghost is; empty where there is none."""
    here = ghost_at(track, elapsed)
    if here is None:
        return []
    first, last = max(elapsed - seconds, 0.0) / track.every_s, elapsed / track.every_s
    return [*track.points[math.ceil(first) : math.floor(last) + 1], here]
