"""The obstacles of a world: how far a point is from them, which is nearest, and which way leads out.

Signed distance: positive outside, negative inside, exact everywhere outside. World ENU, metres.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import cos, hypot, inf, radians, sin, sqrt
from typing import NamedTuple, Protocol

from sim.kinematics import Vector3
from sim.scenario import Box, Cylinder, Obstacle, Sphere

FLOOR_NAME = "floor"
_SURFACE = 1e-3


class Solid(Protocol):
    """An obstacle prepared for distance; all are convex."""

    name: str

    def distance(self, x: float, y: float, z: float) -> float:
        """Return the signed distance of a point, m."""
        ...

    def normal(self, x: float, y: float, z: float) -> Vector3:
        """Return the gradient of the distance: the unit vector that leads away from the solid."""
        ...


class Nearest(NamedTuple):
    """The obstacle nearest to a point.

    Attributes:
        distance: Signed, m; infinite where there is none.
        name: Its name, or "".
        normal: Unit vector away from it, world; zero where there is none.
    """

    distance: float
    name: str
    normal: Vector3


class World:
    """All obstacles.

    Args:
        obstacles: From the mission.
        floor: Count the ground, z = 0, as one more obstacle.
    """

    def __init__(self, obstacles: Iterable[Obstacle] = (), *, floor: bool = False) -> None:
        solids: list[Solid] = [_prepared(obstacle) for obstacle in obstacles]
        if floor:
            solids.append(_Floor())
        self.solids = tuple(solids)

    def clearance(self, point: Vector3) -> tuple[float, str]:
        """Return the signed distance to the nearest obstacle, m, and its name; infinity and "" in an empty world."""
        distance, solid = self._nearest(point)
        return distance, solid.name if solid else ""

    def nearest(self, point: Vector3) -> Nearest:
        """Return the nearest obstacle with the way out."""
        distance, solid = self._nearest(point)
        if solid is None:
            return Nearest(inf, "", (0.0, 0.0, 0.0))
        return Nearest(distance, solid.name, solid.normal(*point))

    def ray(self, origin: Vector3, heading: Vector3, limit: float) -> float:
        """Return the way from `origin` along the unit vector `heading` to the first surface, m; at most `limit`."""
        along = 0.0
        while along < limit:
            distance, _ = self.clearance(
                (
                    origin[0] + along * heading[0],
                    origin[1] + along * heading[1],
                    origin[2] + along * heading[2],
                )
            )
            if distance <= _SURFACE:
                return along
            along += distance
        return limit

    def _nearest(self, point: Vector3) -> tuple[float, Solid | None]:
        x, y, z = point
        least, nearest = inf, None
        for solid in self.solids:
            distance = solid.distance(x, y, z)
            if distance < least:
                least, nearest = distance, solid
        return least, nearest


class _Box:
    def __init__(self, box: Box) -> None:
        self.name = box.name
        self._center = box.center
        self._half = (0.5 * box.size[0], 0.5 * box.size[1], 0.5 * box.size[2])
        yaw = radians(box.yaw_deg)
        self._c, self._s = cos(yaw), sin(yaw)

    def _local(self, x: float, y: float, z: float) -> Vector3:
        """Turn a world point onto the box's own axes, from its centre."""
        dx, dy = x - self._center[0], y - self._center[1]
        return self._c * dx + self._s * dy, self._c * dy - self._s * dx, z - self._center[2]

    def distance(self, x: float, y: float, z: float) -> float:
        u, v, w = self._local(x, y, z)
        a, b, c = abs(u) - self._half[0], abs(v) - self._half[1], abs(w) - self._half[2]
        if a <= 0.0 and b <= 0.0 and c <= 0.0:
            return max(a, b, c)
        a, b, c = max(a, 0.0), max(b, 0.0), max(c, 0.0)
        return sqrt(a * a + b * b + c * c)

    def normal(self, x: float, y: float, z: float) -> Vector3:
        local = self._local(x, y, z)
        beyond = [abs(value) - half for value, half in zip(local, self._half, strict=True)]
        deepest = max(beyond)
        if deepest > 0.0:
            out = [max(value, 0.0) for value in beyond]
        else:
            out = [float(index == beyond.index(deepest)) for index in range(3)]
        length = hypot(*out)
        u, v, w = ((size if value >= 0.0 else -size) / length for size, value in zip(out, local, strict=True))
        return self._c * u - self._s * v, self._s * u + self._c * v, w


class _Cylinder:
    def __init__(self, cylinder: Cylinder) -> None:
        self.name = cylinder.name
        self._center = cylinder.center
        self._radius = cylinder.radius
        self._half = 0.5 * cylinder.height

    def distance(self, x: float, y: float, z: float) -> float:
        dx, dy = x - self._center[0], y - self._center[1]
        a = sqrt(dx * dx + dy * dy) - self._radius
        b = abs(z - self._center[2]) - self._half
        if a <= 0.0 or b <= 0.0:
            return max(a, b)
        return sqrt(a * a + b * b)

    def normal(self, x: float, y: float, z: float) -> Vector3:
        dx, dy, dz = x - self._center[0], y - self._center[1], z - self._center[2]
        across = hypot(dx, dy)
        ux, uy = (dx / across, dy / across) if across > 0.0 else (1.0, 0.0)
        a, b = across - self._radius, abs(dz) - self._half
        if a <= 0.0 or b <= 0.0:
            a, b = (1.0, 0.0) if a > b else (0.0, 1.0)
        length = hypot(a, b)
        return ux * a / length, uy * a / length, (b if dz >= 0.0 else -b) / length


class _Sphere:
    def __init__(self, sphere: Sphere) -> None:
        self.name = sphere.name
        self._center = sphere.center
        self._radius = sphere.radius

    def distance(self, x: float, y: float, z: float) -> float:
        dx, dy, dz = x - self._center[0], y - self._center[1], z - self._center[2]
        return sqrt(dx * dx + dy * dy + dz * dz) - self._radius

    def normal(self, x: float, y: float, z: float) -> Vector3:
        dx, dy, dz = x - self._center[0], y - self._center[1], z - self._center[2]
        length = hypot(dx, dy, dz)
        return (dx / length, dy / length, dz / length) if length > 0.0 else (0.0, 0.0, 1.0)


class _Floor:
    name = FLOOR_NAME

    def distance(self, x: float, y: float, z: float) -> float:  # noqa: ARG002
        return z

    def normal(self, x: float, y: float, z: float) -> Vector3:  # noqa: ARG002
        return 0.0, 0.0, 1.0


def _prepared(obstacle: Obstacle) -> Solid:
    match obstacle:
        case Box():
            return _Box(obstacle)
        case Cylinder():
            return _Cylinder(obstacle)
        case Sphere():
            return _Sphere(obstacle)
