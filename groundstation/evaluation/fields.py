"""Fields of obstacles, made by chance from a seed: somewhere to fly into things."""

from __future__ import annotations

import math
from random import Random

from sim.scenario import Box, Cylinder, Obstacle, Sphere, Wall

# Obstacles stand within this square around the pad, m, and leave the pad free.
HALF_SIDE = 10.0
FREE_AROUND_PAD = 2.5
COUNT = 20


def obstacle_field(seed: int, count: int = COUNT) -> tuple[Obstacle, ...]:
    """Return `count` obstacles of all kinds and sizes; they may stand in each other. Same seed, same field."""
    random = Random(f"field {seed}")
    made: list[Obstacle] = []
    while len(made) < count:
        kind = random.choice((_box, _cylinder, _sphere, _wall))
        x, y = random.uniform(-HALF_SIDE, HALF_SIDE), random.uniform(-HALF_SIDE, HALF_SIDE)
        obstacle, reach = kind(random, f"{kind.__name__[1:]} {len(made)}", x, y)
        if math.hypot(x, y) - reach > FREE_AROUND_PAD:
            made.append(obstacle)
    return tuple(made)


def middles(obstacles: tuple[Obstacle, ...]) -> tuple[tuple[float, float, float], ...]:
    """Return a point inside each obstacle of a field, world, m."""
    return tuple(_middle(obstacle) for obstacle in obstacles)


def _middle(obstacle: Obstacle) -> tuple[float, float, float]:
    if isinstance(obstacle, Wall):
        (x, y), (u, v) = obstacle.start, obstacle.end
        return 0.5 * (x + u), 0.5 * (y + v), 0.5 * obstacle.height
    return obstacle.center


# Each makes an obstacle about x, y, and says how far it reaches from there in the plane, m.


def _box(random: Random, name: str, x: float, y: float) -> tuple[Obstacle, float]:
    width, depth, height = (random.uniform(0.3, 3.0) for _ in range(3))
    z = 0.5 * height + random.choice((0.0, random.uniform(0.0, 3.0)))
    box = Box(name, (x, y, z), (width, depth, height), random.uniform(0.0, 180.0))
    return box, 0.5 * math.hypot(width, depth)


def _cylinder(random: Random, name: str, x: float, y: float) -> tuple[Obstacle, float]:
    radius, height = random.uniform(0.1, 1.0), random.uniform(1.0, 6.0)
    return Cylinder(name, (x, y, 0.5 * height), radius, height), radius


def _sphere(random: Random, name: str, x: float, y: float) -> tuple[Obstacle, float]:
    radius = random.uniform(0.2, 1.2)
    return Sphere(name, (x, y, random.uniform(0.5, 4.0)), radius), radius


def _wall(random: Random, name: str, x: float, y: float) -> tuple[Obstacle, float]:
    half, along = random.uniform(0.5, 3.0), random.uniform(0.0, math.pi)
    u, v = half * math.cos(along), half * math.sin(along)
    wall = Wall(name, (x - u, y - v), (x + u, y + v), random.uniform(1.0, 4.0))
    return wall, half
