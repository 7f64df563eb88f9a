"""Distances of many points at once: `sim.environment.world` on arrays. Only who needs it imports it (NumPy).

World ENU, metres; points have shape (n, 3), one a row.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from sim.environment.world import World
from sim.scenario import Box, Cylinder, Primitive, Sphere

Floats = NDArray[np.float64]


class Field:
    """The signed distance of a world.

    Args:
        world: The obstacles, and the floor if it counts there.
    """

    def __init__(self, world: World) -> None:
        self._parts: list[Callable[[Floats], tuple[Floats, Floats]]] = [
            _measured(part) for part in world.primitives
        ]
        if world.floor:
            self._parts.append(_floor)

    def distance(self, points: Floats) -> Floats:
        """Return the signed distances to the nearest obstacle, shape (n,); infinite in an empty world."""
        return self._look(points)[0]

    def nearest(self, points: Floats) -> Floats:
        """Return the nearest points on a surface, shape (n, 3); the points themselves in an empty world."""
        distance, normal = self._look(points)
        step = np.where(np.isfinite(distance), distance, 0.0)
        return points - step[:, None] * normal

    def _look(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the least distance, shape (n,), and the unit vector away from what is nearest, shape (n, 3)."""
        distance = np.full(len(points), np.inf)
        normal = np.zeros((len(points), 3))
        for part in self._parts:
            there, away = part(points)
            nearer = there < distance
            distance[nearer], normal[nearer] = there[nearer], away[nearer]
        return distance, normal


def _measured(part: Primitive) -> Callable[[Floats], tuple[Floats, Floats]]:
    """Return a function from points to signed distances and normals of one part."""
    center = np.array(part.center)
    match part:
        case Box():
            half = 0.5 * np.array(part.size)
            yaw = radians(part.yaw_deg)
            turn = np.array([[cos(yaw), -sin(yaw), 0.0], [sin(yaw), cos(yaw), 0.0], [0.0, 0.0, 1.0]])
            return lambda points: _box((points - center) @ turn, half, turn)
        case Cylinder():
            size = np.array((part.radius, 0.5 * part.height))
            return lambda points: _cylinder(points - center, size)
        case Sphere():
            radius = part.radius
            return lambda points: _sphere(points - center, radius)


def _box(local: Floats, half: Floats, turn: Floats) -> tuple[Floats, Floats]:
    """Measure points on a box's own axes."""
    distance, out = _cornered(np.abs(local) - half)
    return distance, np.copysign(out, local) @ turn.T


def _cylinder(local: Floats, size: Floats) -> tuple[Floats, Floats]:
    """Measure points from a cylinder's middle; `size` is radius and half height."""
    across = np.hypot(local[:, 0], local[:, 1])
    distance, out = _cornered(np.stack((across, np.abs(local[:, 2])), axis=1) - size)
    on_axis = across == 0.0
    outward = local[:, :2] / np.where(on_axis, 1.0, across)[:, None]
    outward[on_axis] = (1.0, 0.0)
    return distance, np.column_stack((outward * out[:, :1], np.copysign(out[:, 1], local[:, 2])))


def _sphere(local: Floats, radius: float) -> tuple[Floats, Floats]:
    length = np.sqrt(np.einsum("ij,ij->i", local, local))
    normal = local / np.where(length == 0.0, 1.0, length)[:, None]
    normal[length == 0.0] = (0.0, 0.0, 1.0)
    return length - radius, normal


def _floor(points: Floats) -> tuple[Floats, Floats]:
    return points[:, 2].copy(), np.broadcast_to((0.0, 0.0, 1.0), points.shape)


def _cornered(beyond: Floats) -> tuple[Floats, Floats]:
    """Return distance and unit normal from how far points are beyond each face, shape (n, axes)."""
    deepest = beyond.max(axis=1)
    outside = np.maximum(beyond, 0.0)
    length = np.sqrt(np.einsum("ij,ij->i", outside, outside))
    far = length > 0.0
    inward = np.arange(beyond.shape[1]) == beyond.argmax(axis=1)[:, None]
    normal = np.where(far[:, None], outside / np.where(far, length, 1.0)[:, None], inward)
    return np.where(far, length, deepest), normal
