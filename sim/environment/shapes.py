"""What obstacles are made of, how far they reach, and the way through a gate."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import atan2, cos, degrees, hypot, radians, sin

from sim.scenario import Box, Cylinder, Gate, Obstacle, Point, Primitive, Sphere, Wall


def primitives(obstacle: Obstacle) -> tuple[Primitive, ...]:
    """Return what an obstacle is made of. All parts carry its name; they touch but do not overlap."""
    match obstacle:
        case Wall():
            return (_wall_box(obstacle),)
        case Gate():
            return _gate_frame(obstacle)
        case _:
            return (obstacle,)


def reach(part: Primitive) -> float:
    """Return how far a part reaches from its centre in the plane, m."""
    return 0.5 * hypot(part.size[0], part.size[1]) if isinstance(part, Box) else part.radius


def half_height(part: Primitive) -> float:
    """Return how far a part reaches from its centre up and down, m."""
    match part:
        case Box():
            return 0.5 * part.size[2]
        case Cylinder():
            return 0.5 * part.height
        case Sphere():
            return part.radius


def extent(obstacle: Obstacle) -> tuple[Point, Point]:
    """Return the lower and the upper corner of the upright box around an obstacle, world, m."""
    corners = [_corners(part) for part in primitives(obstacle)]
    lowest, highest = ([corner[end] for corner in corners] for end in (0, 1))
    return _each(min, lowest), _each(max, highest)


def _corners(part: Primitive) -> tuple[Point, Point]:
    x, y, z = part.center
    east = north = reach(part)
    up = half_height(part)
    if isinstance(part, Box):
        yaw, (length, width, _) = radians(part.yaw_deg), part.size
        c, s = abs(cos(yaw)), abs(sin(yaw))
        east, north = 0.5 * (c * length + s * width), 0.5 * (s * length + c * width)
    return (x - east, y - north, z - up), (x + east, y + north, z + up)


def _each(choose: Callable[[Iterable[float]], float], points: list[Point]) -> Point:
    xs, ys, zs = zip(*points, strict=True)
    return choose(xs), choose(ys), choose(zs)


def _wall_box(wall: Wall) -> Box:
    (x0, y0), (x1, y1) = wall.start, wall.end
    return Box(
        wall.name,
        (0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * wall.height),
        (hypot(x1 - x0, y1 - y0), wall.thickness, wall.height),
        degrees(atan2(y1 - y0, x1 - x0)),
    )


def _gate_frame(gate: Gate) -> tuple[Box, ...]:
    """Return two posts, the beam above, and the sill if there is one."""
    x, y, z = gate.center
    yaw, frame = radians(gate.yaw_deg), gate.frame
    aside = 0.5 * (gate.width + frame)
    bottom, top = (z - 0.5 * gate.height if gate.sill else 0.0), z + 0.5 * gate.height
    post, beam = (frame, frame, top - bottom), (frame, gate.width + 2.0 * frame, frame)
    parts = [
        Box(
            gate.name,
            (x - sin(yaw) * left, y + cos(yaw) * left, 0.5 * (bottom + top)),
            post,
            gate.yaw_deg,
        )
        for left in (aside, -aside)
    ]
    heights = (top + 0.5 * frame, bottom - 0.5 * frame)[: 2 if gate.sill else 1]
    parts += [Box(gate.name, (x, y, height), beam, gate.yaw_deg) for height in heights]
    return tuple(parts)


def flown_through(gate: Gate, before: Point, after: Point) -> bool:
    """Say whether the straight way between two points leads through a gate's opening, from either side."""
    yaw = radians(gate.yaw_deg)
    c, s = cos(yaw), sin(yaw)
    ends = [(x - gate.center[0], y - gate.center[1], z - gate.center[2]) for x, y, z in (before, after)]
    depths = [c * x + s * y for x, y, _ in ends]
    if (depths[0] < 0.0) == (depths[1] < 0.0):
        return False
    share = depths[0] / (depths[0] - depths[1])
    x, y, z = (a + share * (b - a) for a, b in zip(*ends, strict=True))
    return abs(c * y - s * x) < 0.5 * gate.width and abs(z) < 0.5 * gate.height
