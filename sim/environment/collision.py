"""What obstacles do to a vehicle: a sphere that bounces or stops at their surface, slides along, never passes.

Each solid is convex and its distance is exact outside, so a sphere of radius r may travel as far as the distance
minus r before it can touch (sphere tracing). That is tried again and again until it touches or has travelled all the
way: no speed is too high.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

from sim.environment.world import Solid, World
from sim.kinematics import Vector3

# The surface is touched within the skin; it is left beyond the release distance, so that resting on it, or
# bouncing at it, is one contact.
SKIN = 1e-3
RELEASE = 0.1
# Slower than this nothing bounces, m/s: contact that goes on is contact.
_BOUNCES_OVER = 0.2
_SLIDES = 4
# A way this little into a surface is along it: rounding must not glue the vehicle to a wall.
_ALONG = -1e-9


class Strike(NamedTuple):
    """A contact that has just begun: with what, and the unit normal of its surface there."""

    name: str
    normal: Vector3


class Collider:
    """A sphere among obstacles.

    Args:
        world: The obstacles.
        radius: Of the vehicle, m.
    """

    def __init__(self, world: World, radius: float) -> None:
        self._solids = world.solids
        self._radius = radius
        self._free = 0.0
        self._touching: set[str] = set()
        self.normals: list[Vector3] = []
        self.struck: list[Strike] = []

    def travel(self, start: Vector3, end: Vector3) -> Vector3:
        """Return where a motion from `start` to `end` ends. World, m.

        Afterwards `normals` holds the unit normals of the surfaces it was stopped by,
        and `struck` the contacts with obstacles that were not touched before.
        """
        self.normals.clear()
        self.struck.clear()
        # Distances change by no more than the way travelled: what was free at the last look still is.
        x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
        self._free -= sqrt(x * x + y * y + z * z)
        if self._free > 0.0:
            return end
        position, way = start, (x, y, z)
        for _ in range(_SLIDES):
            position, solid = self._until_contact(position, way)
            if solid is None:
                break
            normal = solid.normal(*position)
            self.normals.append(normal)
            if solid.name not in self._touching:
                self._touching.add(solid.name)
                self.struck.append(Strike(solid.name, normal))
            way = without(_minus(end, position), self.normals)
        self._look(position)
        return position

    def _until_contact(self, start: Vector3, way: Vector3) -> tuple[Vector3, Solid | None]:
        """Return where `way` first touches a solid that it leads into, and the solid; or its end and None."""
        length = sqrt(way[0] ** 2 + way[1] ** 2 + way[2] ** 2)
        if length == 0.0:
            return start, None
        heading = (way[0] / length, way[1] / length, way[2] / length)
        first, touched = length, None
        for solid in self._solids:
            along = self._free_way(solid, start, heading, first)
            if along < first:
                first, touched = along, solid
        return _ahead(start, heading, first), touched

    def _free_way(self, solid: Solid, start: Vector3, heading: Vector3, limit: float) -> float:
        """Return the way along `heading` to the contact with one solid; infinity if there is none up to `limit`."""
        along = 0.0
        while along < limit:
            point = _ahead(start, heading, along)
            gap = solid.distance(*point) - self._radius
            if gap <= SKIN:
                normal = solid.normal(*point)
                into = heading[0] * normal[0] + heading[1] * normal[1] + heading[2] * normal[2]
                return along if into < _ALONG else inf
            along += gap
        return inf

    def _look(self, position: Vector3) -> None:
        """Measure anew how far nothing can be touched, and let go of what has been left."""
        self._free = inf
        near: set[str] = set()
        for solid in self._solids:
            gap = solid.distance(*position) - self._radius
            self._free = min(self._free, gap - SKIN)
            if gap <= RELEASE:
                near.add(solid.name)
        self._touching &= near


def impact_speed(velocity: Vector3, normal: Vector3) -> float:
    """Return how fast a velocity leads into a surface, m/s; 0 where it leads away."""
    return max(0.0, -(velocity[0] * normal[0] + velocity[1] * normal[1] + velocity[2] * normal[2]))


def bounced(velocity: Vector3, strikes: list[Strike], restitution: float) -> Vector3:
    """Return a velocity after new contacts: v − (1 + e) (v·n) n for each that is fast enough to bounce.

    Args:
        velocity: World, m/s.
        strikes: The contacts.
        restitution: e, 0 to 1.
    """
    x, y, z = velocity
    for _, normal in strikes:
        into = impact_speed((x, y, z), normal)
        if into > _BOUNCES_OVER:
            push = (1.0 + restitution) * into
            x, y, z = x + push * normal[0], y + push * normal[1], z + push * normal[2]
    return x, y, z


def without(vector: Vector3, normals: list[Vector3]) -> Vector3:
    """Return a vector without its parts into surfaces of the given unit normals.

    Where taking out one part brings back another (a corner), nothing of it is left.
    """
    x, y, z = vector
    for normal in normals:
        into = min(x * normal[0] + y * normal[1] + z * normal[2], 0.0)
        x, y, z = x - into * normal[0], y - into * normal[1], z - into * normal[2]
    if any(x * normal[0] + y * normal[1] + z * normal[2] < -1e-12 for normal in normals):
        return 0.0, 0.0, 0.0
    return x, y, z


def _minus(a: Vector3, b: Vector3) -> Vector3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _ahead(start: Vector3, heading: Vector3, along: float) -> Vector3:
    return start[0] + heading[0] * along, start[1] + heading[1] * along, start[2] + heading[2] * along
