"""Rangefinders in the simulated world: a level ring of rays, and one that looks down. Exact, without noise.

World ENU, metres; infinite where nothing is within reach.
"""

from __future__ import annotations

from math import asin, atan2, ceil, cos, floor, hypot, inf, radians, sin, tau

from sim.environment.shapes import half_height, reach
from sim.environment.world import World
from sim.kinematics import Vector3, Vector4, wrap
from sim.scenario import Box, Primitive

# A ray a 5° sector, as many as MAVLink's OBSTACLE_DISTANCE has room for.
SECTORS = 72
# How far usual scanning rangefinders see, m (Slamtec RPLIDAR A2, datasheet: 12 m).
RING_LIMIT = 12.0


def ring(world: World, p: Vector4, count: int = SECTORS, limit: float = RING_LIMIT) -> tuple[float, ...]:
    """Return the distances to the obstacles around, on the vehicle's level.

    Args:
        world: The obstacles; the ground is not seen.
        p: Where the vehicle is; its yaw is where ray 0 points.
        count: Rays; ray i is turned by i · 2π/count counter-clockwise from forward.
        limit: Beyond it nothing is seen, m.

    Returns:
        `count` distances from the vehicle's middle, m; 0 within an obstacle, infinite where there is none.
    """
    x, y, z, yaw = p
    step = tau / count
    distances = [inf] * count
    for part, solid in zip(world.primitives, world.solids, strict=False):
        east, north, up = part.center
        across = hypot(east - x, north - y)
        if abs(up - z) > half_height(part) or across - reach(part) > limit:
            continue
        rays = range(count)
        if sector := _sector(part, x, y):
            rays = range(ceil((sector[0] - yaw) / step), floor((sector[1] - yaw) / step) + 1)
        for ray in rays:
            angle = yaw + ray * step
            distance = solid.ray((x, y, z), (cos(angle), sin(angle), 0.0))
            if distance <= limit and distance < distances[ray % count]:
                distances[ray % count] = distance
    return tuple(distances)


def _sector(part: Primitive, x: float, y: float) -> tuple[float, float] | None:
    """Return the bearings between which a part is seen in the plane, rad; None from within."""
    east, north = part.center[0] - x, part.center[1] - y
    middle = atan2(north, east)
    if not isinstance(part, Box):
        across = hypot(east, north)
        half = asin(part.radius / across) if across > part.radius else None
        return None if half is None else (middle - half, middle + half)
    c, s = cos(radians(part.yaw_deg)), sin(radians(part.yaw_deg))
    length, width = 0.5 * part.size[0], 0.5 * part.size[1]
    if abs(c * east + s * north) <= length and abs(c * north - s * east) <= width:
        return None
    sides = [
        wrap(atan2(north + s * u + c * v, east + c * u - s * v) - middle)
        for u, v in ((length, width), (length, -width), (-length, width), (-length, -width))
    ]
    return middle + min(sides), middle + max(sides)


def below(world: World, position: Vector3, limit: float = inf) -> float:
    """Return the distance straight down to an obstacle or the ground, z = 0; infinite beyond `limit`, m."""
    distance = world.ray(position, (0.0, 0.0, -1.0), max(position[2], 0.0))
    return distance if distance <= limit else inf
