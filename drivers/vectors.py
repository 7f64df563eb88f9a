"""Vectors of three as plain tuples."""

from __future__ import annotations

import math

from drivers.device import Vector3


def finite(vector: Vector3) -> bool:
    """Say whether no component is NaN or infinite."""
    return math.isfinite(vector[0]) and math.isfinite(vector[1]) and math.isfinite(vector[2])


def within(vector: Vector3, length: float) -> Vector3:
    """Return the vector, shortened to `length` where it is longer; its direction stays."""
    x, y, z = vector
    norm = math.hypot(x, y, z)
    if norm <= length:
        return vector
    scale = length / norm
    return (x * scale, y * scale, z * scale)


def inside(vector: Vector3, limit: float) -> bool:
    """Say whether no component is NaN or beyond ±`limit`."""
    # A comparison with NaN is false.
    return abs(vector[0]) <= limit and abs(vector[1]) <= limit and abs(vector[2]) <= limit
