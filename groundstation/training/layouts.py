"""Where things stand on an obstacle course: the way comes first, and what stands beside it keeps off.

World ENU from the pad on, metres. Every way leads east on the whole and never crosses itself. `room` is what the
middle of the vehicle needs to all sides.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from groundstation.training.checking import clearance
from groundstation.training.mission import Mission, Target, Waypoint
from sim.scenario import Cylinder, Gate, Obstacle, Point, Wall

ALTITUDE_M = 2.0
_Flat = tuple[float, float]


class Grade(NamedTuple):
    """How hard a course is.

    Attributes:
        spare: Room between hull and obstacle beyond the guard's margin, m.
        things: Poles, gates, or legs of the way.
        turn: Largest turn from one leg to the next, rad.
        wind: m/s, from a side that the seed chooses; `turbulence` is its σ_w.
    """

    spare: float
    things: int
    turn: float
    wind: float = 0.0
    turbulence: float = 0.0


class Layout(NamedTuple):
    """A course: the points before the target, the target, and what stands around."""

    route: tuple[Waypoint, ...]
    end: Point
    obstacles: tuple[Obstacle, ...]


def slalom(dice: random.Random, grade: Grade, room: float) -> Layout:
    """Poles in a row, passed left and right in turn.

    From beside one pole to beside the next the way leans by atan(2 aside / pitch), which brings it nearer to both by
    the cosine: with a pitch of 3 aside and more that is 0.83, and aside is larger by more than it takes.
    """
    side = dice.choice((-1.0, 1.0))
    poles: list[Obstacle] = []
    route: list[Waypoint] = []
    x, y = 2.0, 0.0
    for number in range(1, grade.things + 1):
        radius = round(dice.uniform(0.08, 0.2), 2)
        aside = 1.3 * (room + radius)
        x, y = x + 3.0 * aside + dice.uniform(0.5, 1.5), dice.uniform(-0.2, 0.2)
        poles.append(Cylinder(f"pole {number}", _point(x, y, 2.0), radius, 4.0))
        words = f"{'Left' if side > 0 else 'Right'} of pole {number}."
        route.append(
            Waypoint(_point(x, y + side * aside, ALTITUDE_M), radius=round(0.6 * aside, 2), say=words)
        )
        side = -side
    return Layout(tuple(route), _point(x + 4.0 * room + 2.0, y, ALTITUDE_M), tuple(poles))


def gates(dice: random.Random, grade: Grade, room: float) -> Layout:
    """Gates along a bending way, each across the middle of the bend it stands in.

    The way crosses an opening at no more than half of a turn from straight on, and climbs no more than 1 in 5; so
    much wider it is.
    """
    wide = 2.0 * room / math.cos(0.5 * grade.turn) + 0.2
    high = 2.0 * room * math.hypot(1.0, 0.2) + 0.2
    lowest = max(0.5 * high + 0.3, 1.5)
    gates: list[Obstacle] = []
    points = [(0.0, 0.0, ALTITUDE_M)]
    headings = _headings(dice, grade, grade.things + 1)
    for number in range(grade.things):
        x, y, z = points[-1]
        far = dice.uniform(2.5, 4.5) + wide
        z = min(max(dice.uniform(z - 0.5, z + 0.5), lowest), lowest + 1.5, z + 0.2 * far)
        points.append((x + far * math.cos(headings[number]), y + far * math.sin(headings[number]), z))
        yaw = math.degrees(0.5 * (headings[number] + headings[number + 1]))
        gates.append(
            Gate(f"gate {number + 1}", _point(*points[-1]), round(wide, 2), round(high, 2), round(yaw, 1))
        )
    x, y, z = points[-1]
    end = (x + (4.0 + room) * math.cos(headings[-1]), y + (4.0 + room) * math.sin(headings[-1]), z)
    route = [
        Waypoint(_point(*point), radius=round(0.4 * wide, 2), say=f"Through gate {number}.")
        for number, point in enumerate(points[1:], 1)
    ]
    return Layout(tuple(route), _point(*end), tuple(gates))


def forest(dice: random.Random, grade: Grade, room: float) -> Layout:
    """A winding way, and trees as near to it as they may stand."""
    points = _bending(dice, grade, (0.0, 0.0), grade.things + 1, room + 3.0)
    route = [
        Waypoint(_point(x, y, ALTITUDE_M), radius=round(0.8 + 0.3 * room, 2), say="On between the trees.")
        for x, y in points[1:-1]
    ]
    empty = Mission(1, "f", "f", route=tuple(route), target=Target(_point(*points[-1], ALTITUDE_M)))
    trees: list[Obstacle] = []
    for _ in range(12 * grade.things):
        if len(trees) == 3 * grade.things:
            break
        (x, y), (east, north) = _along(dice, points)
        radius = round(dice.uniform(0.15, 0.35), 2)
        off = dice.choice((-1.0, 1.0)) * (room + radius + 0.1 + dice.expovariate(0.7))
        tree = Cylinder(f"tree {len(trees) + 1}", _point(x - off * north, y + off * east, 3.0), radius, 6.0)
        apart = all(
            math.dist(tree.center, other.center) > 1.5 for other in trees if isinstance(other, Cylinder)
        )
        if apart and clearance(empty, [tree]) >= room:
            trees.append(tree)
    return Layout(tuple(route), empty.way[-1], tuple(trees))


def corridor(dice: random.Random, grade: Grade, room: float) -> Layout:
    """A bending corridor with places to stay at, nose to a wall.

    Its walls are the middle line moved aside: where it bends by φ the corner lies 1/cos(φ/2) as far out.
    """
    bends = max(grade.things - 2, 1)
    points = [(2.0, 0.0), *_bending(dice, grade, (4.0 + 2.0 * room, 0.0), bends + 1, 3.0 + 2.0 * room)]
    walls = [
        wall
        for side, where in ((1.0, "left"), (-1.0, "right"))
        for wall in _walls(points, side * (room + 0.15), where)
    ]
    route: list[Waypoint] = []
    for number, ((x0, y0), (x1, y1)) in enumerate(pairwise(points), 1):
        side = dice.choice((1, -1))
        yaw = math.remainder(math.atan2(y1 - y0, x1 - x0) + 0.5 * math.pi * side, math.tau)
        words = f"Stay here with the nose to the {'left' if side > 0 else 'right'} wall."
        middle = _point(0.5 * (x0 + x1), 0.5 * (y0 + y1), ALTITUDE_M)
        route.append(Waypoint(middle, radius=0.7, hold_s=2.0, yaw_deg=round(math.degrees(yaw), 1), say=words))
        route.append(
            Waypoint(_point(x1, y1, ALTITUDE_M), radius=0.8, say=f"On along piece {number} to its end.")
        )
    (x0, y0), (x1, y1) = points[-2:]
    far = math.dist((x0, y0), (x1, y1))
    end = _point(x1 + 3.0 * (x1 - x0) / far, y1 + 3.0 * (y1 - y0) / far, ALTITUDE_M)
    return Layout(tuple(route), end, tuple(walls))


def _walls(points: Sequence[_Flat], aside: float, where: str) -> list[Wall]:
    """Return the walls beside a line of points, so far to its left."""
    headings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(points)]
    corners: list[_Flat] = []
    for (x, y), before, after in zip(
        points, [headings[0], *headings], [*headings, headings[-1]], strict=True
    ):
        across, out = 0.5 * (before + after) + 0.5 * math.pi, aside / math.cos(0.5 * (after - before))
        corners.append((round(x + out * math.cos(across), 2), round(y + out * math.sin(across), 2)))
    return [
        Wall(f"{where} wall {number}", start, end, 3.5, 0.15)
        for number, (start, end) in enumerate(pairwise(corners), 1)
    ]


def _headings(dice: random.Random, grade: Grade, count: int) -> list[float]:
    """Return so many headings, each no more than a turn from the one before, never more than 60° off east."""
    found = [0.0]
    most = math.radians(60.0)
    while len(found) < count:
        found.append(min(max(found[-1] + dice.uniform(-grade.turn, grade.turn), -most), most))
    return found


def _bending(dice: random.Random, grade: Grade, start: _Flat, count: int, least: float) -> list[_Flat]:
    """Return a bending line of so many legs, each at least so long, m."""
    points = [start]
    for heading in _headings(dice, grade, count):
        far = least + dice.uniform(0.0, 2.0)
        points.append((points[-1][0] + far * math.cos(heading), points[-1][1] + far * math.sin(heading)))
    return points


def _along(dice: random.Random, points: Sequence[_Flat]) -> tuple[_Flat, _Flat]:
    """Return a place on a line of points and the unit vector along it there."""
    leg = dice.randrange(len(points) - 1)
    (x0, y0), (x1, y1) = points[leg], points[leg + 1]
    share, far = dice.random(), math.dist(points[leg], points[leg + 1])
    return (x0 + share * (x1 - x0), y0 + share * (y1 - y0)), ((x1 - x0) / far, (y1 - y0) / far)


def _point(x: float, y: float, z: float) -> Point:
    """Round to what a file shows; courses have so much to spare."""
    return round(x, 2), round(y, 2), round(z, 2)
