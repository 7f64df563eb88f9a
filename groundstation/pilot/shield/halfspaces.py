"""The point nearest to another within several half-spaces: a small quadratic program, solved exactly.

Half-spaces are taken one after the other. As long as the best point so far satisfies the next, it stays the best;
where it does not, the best lies on that half-space's plane, and is sought there, among those that came before, with
one dimension less (Seidel 1991, Small-dimensional linear programming and convex hulls made easy; the argument holds
for any strictly convex goal).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from drivers.device import Vector3

# n · x ≥ c with |n| = 1.
Halfspace = tuple[Vector3, float]

_TINY = 1e-9
# Components smaller than this lie along the plane: nothing is gained by dividing by them.
_ALONG = 1e-6


def nearest_within(wanted: Vector3, halfspaces: Sequence[Halfspace]) -> Vector3 | None:
    """Return the point within all half-spaces that is nearest to `wanted`, or None where there is none.

    Args:
        wanted: Any point.
        halfspaces: Unit normals n and offsets c of n · x ≥ c.
    """
    return _nearest(wanted, halfspaces, 3)


def _nearest(wanted: Vector3, halfspaces: Sequence[Halfspace], freedom: int) -> Vector3 | None:
    best = wanted
    for index, (normal, offset) in enumerate(halfspaces):
        if _dot(normal, best) >= offset - _TINY:
            continue
        if not freedom:
            return None
        lift = offset - _dot(normal, wanted)
        foot = (wanted[0] + lift * normal[0], wanted[1] + lift * normal[1], wanted[2] + lift * normal[2])
        within = _on_plane(halfspaces[:index], normal, foot)
        found = None if within is None else _nearest(foot, within, freedom - 1)
        if found is None:
            return None
        best = found
    return best


def _on_plane(halfspaces: Sequence[Halfspace], normal: Vector3, foot: Vector3) -> list[Halfspace] | None:
    """Return what half-spaces leave of a plane through `foot`, or None where one leaves nothing."""
    left: list[Halfspace] = []
    for other, offset in halfspaces:
        across = _dot(other, normal)
        x, y, z = (
            other[0] - across * normal[0],
            other[1] - across * normal[1],
            other[2] - across * normal[2],
        )
        length = sqrt(x * x + y * y + z * z)
        # On the plane n·x is fixed, so that part of the other's condition is settled.
        beyond = offset - across * _dot(normal, foot)
        if length > _ALONG:
            left.append(((x / length, y / length, z / length), beyond / length))
        elif beyond > _TINY:
            return None
    return left


def _dot(a: Vector3, b: Vector3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
