"""The obstacles of a world: how far a point is from them, which is nearest, where a ray meets them.

Signed distance: positive outside, negative inside, exact everywhere outside. World ENU, metres. Many points at once
are `sim.environment.field`'s business.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import copysign, cos, hypot, inf, radians, sin, sqrt
from typing import NamedTuple, Protocol

from sim.environment.shapes import primitives
from sim.kinematics import Vector3
from sim.scenario import Box, Cylinder, Obstacle, Primitive, Sphere

FLOOR_NAME = "floor"


class Solid(Protocol):
    """An obstacle prepared for distance; all are convex."""

    name: str

    def distance(self, x: float, y: float, z: float) -> float:
        """Return the signed distance of a point, m."""
        ...

    def normal(self, x: float, y: float, z: float) -> Vector3:
        """Return the gradient of the distance: the unit vector that leads away from the solid."""
        ...

    def ray(self, origin: Vector3, heading: Vector3) -> float:
        """Return the way along a unit vector to the surface, m: 0 from within, infinite where it is missed."""
        ...


class Nearest(NamedTuple):
    """The obstacle nearest to a point.

    Attributes:
        distance: Signed, m; infinite where there is none.
        name: Its name, or "".
        normal: Unit vector away from it, world; zero where there is none.
        point: Of its surface, the one nearest; the asked one where there is none.
    """

    distance: float
    name: str
    normal: Vector3
    point: Vector3


class World:
    """All obstacles.

    Args:
        obstacles: From the mission.
        floor: Count the ground, z = 0, as one more obstacle.

    Attributes:
        primitives: What the obstacles are made of, without the floor.
        solids: The same prepared for distance, and the floor if it counts.
    """

    def __init__(self, obstacles: Iterable[Obstacle] = (), *, floor: bool = False) -> None:
        self.primitives = tuple(part for obstacle in obstacles for part in primitives(obstacle))
        self.floor = floor
        solids: list[Solid] = [_prepared(part) for part in self.primitives]
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
            return Nearest(inf, "", (0.0, 0.0, 0.0), point)
        normal = solid.normal(*point)
        x, y, z = (at - distance * away for at, away in zip(point, normal, strict=True))
        return Nearest(distance, solid.name, normal, (x, y, z))

    def ray(self, origin: Vector3, heading: Vector3, limit: float) -> float:
        """Return the way from `origin` along the unit vector `heading` to the first surface, m; at most `limit`."""
        return min(limit, *(solid.ray(origin, heading) for solid in self.solids), inf)

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
        u, v, w = self._local(x, y, z)
        a, b, c = abs(u) - self._half[0], abs(v) - self._half[1], abs(w) - self._half[2]
        if a <= 0.0 and b <= 0.0 and c <= 0.0:
            # Within, the way out is the nearest face's.
            if a >= b and a >= c:
                a, b, c = 1.0, 0.0, 0.0
            else:
                a, b, c = (0.0, 1.0, 0.0) if b >= c else (0.0, 0.0, 1.0)
        a, b, c = max(a, 0.0), max(b, 0.0), max(c, 0.0)
        length = sqrt(a * a + b * b + c * c)
        a, b, c = copysign(a, u) / length, copysign(b, v) / length, copysign(c, w) / length
        return self._c * a - self._s * b, self._s * a + self._c * b, c

    def ray(self, origin: Vector3, heading: Vector3) -> float:
        """Intersect with the three slabs that a box is (Kay and Kajiya 1986, Ray tracing complex scenes)."""
        u, v, w = self._local(*origin)
        c, s = self._c, self._s
        ways = (c * heading[0] + s * heading[1], c * heading[1] - s * heading[0], heading[2])
        return _through(
            (_slab(at, way, half) for at, way, half in zip((u, v, w), ways, self._half, strict=True))
        )


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

    def ray(self, origin: Vector3, heading: Vector3) -> float:
        dx, dy = origin[0] - self._center[0], origin[1] - self._center[1]
        along, toward = heading[0] ** 2 + heading[1] ** 2, dx * heading[0] + dy * heading[1]
        around = _round(along, toward, dx * dx + dy * dy - self._radius**2)
        return _through((around, _slab(origin[2] - self._center[2], heading[2], self._half)))


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

    def ray(self, origin: Vector3, heading: Vector3) -> float:
        (x, y, z), (east, north, up) = origin, self._center
        dx, dy, dz = x - east, y - north, z - up
        toward = dx * heading[0] + dy * heading[1] + dz * heading[2]
        return _through((_round(1.0, toward, dx * dx + dy * dy + dz * dz - self._radius**2),))


class _Floor:
    name = FLOOR_NAME

    def distance(self, x: float, y: float, z: float) -> float:  # noqa: ARG002
        return z

    def normal(self, x: float, y: float, z: float) -> Vector3:  # noqa: ARG002
        return 0.0, 0.0, 1.0

    def ray(self, origin: Vector3, heading: Vector3) -> float:
        if origin[2] <= 0.0:
            return 0.0
        return origin[2] / -heading[2] if heading[2] < 0.0 else inf


def _prepared(part: Primitive) -> Solid:
    match part:
        case Box():
            return _Box(part)
        case Cylinder():
            return _Cylinder(part)
        case Sphere():
            return _Sphere(part)


def _slab(at: float, way: float, half: float) -> tuple[float, float]:
    """Return where a line with coordinate `at + t way` is within ±half: from t to t."""
    if way == 0.0:
        return (-inf, inf) if abs(at) <= half else (inf, -inf)
    one, other = (-half - at) / way, (half - at) / way
    return (one, other) if one <= other else (other, one)


def _round(along: float, toward: float, over: float) -> tuple[float, float]:
    """Return where `along t² + 2 toward t + over ≤ 0`: a line within a circle or a sphere."""
    if along == 0.0:
        return (-inf, inf) if over <= 0.0 else (inf, -inf)
    root = toward * toward - along * over
    if root < 0.0:
        return inf, -inf
    root = sqrt(root)
    return (-toward - root) / along, (-toward + root) / along


def _through(spans: Iterable[tuple[float, float]]) -> float:
    """Return the first t ≥ 0 that is within all spans, or infinity."""
    enter, leave = 0.0, inf
    for start, end in spans:
        enter = max(enter, start)
        leave = min(leave, end)
    return enter if enter <= leave else inf
