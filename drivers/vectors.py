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


def slewed(force: Vector3, target: Vector3, step: float) -> Vector3:
    """Move a force straight towards a target by at most `step`, N.

    Raises:
        ValueError: The target is not finite.
    """
    x, y, z = target[0] - force[0], target[1] - force[1], target[2] - force[2]
    distance = math.hypot(x, y, z)
    if not math.isfinite(distance):
        raise ValueError(f"The force {target} is not finite; no hand may feel it.")
    if distance <= step:
        return target
    share = step / distance
    return force[0] + share * x, force[1] + share * y, force[2] + share * z
