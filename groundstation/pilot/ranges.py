"""From the distances that the vehicle's own sensors measure to the few points that matter for the guard.

The guard keeps the vehicle on the near side of the plane through a point, across the way to it. So the nearest echo
matters, then the nearest of those that are still on the near side of all planes so far, and so on: between the planes
is a convex space without an echo in it, as in safe flight corridors (Liu et al. 2017, Planning dynamically feasible
trajectories for quadrotors using safe flight corridors in 3-D complex environments). A wall gives one point, a corner
two, and a vehicle may slide along either. The planes are those of where the vehicle will be: with a delay it is there
that it can still be turned.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, hypot, sin, tau
from typing import NamedTuple

from groundstation.frames import Vector3, Vector4
from groundstation.messages import RING_SECTORS

# What is further than the vehicle can need to stop, with all allowed speed and delay, does not matter, m.
REACH = 5.0
MOST_POINTS = 6
# A share of the hull's radius within which an echo is the vehicle's own: an arm, a rotor, a skid, or dust before the
# lens. Nothing else can be there. Such an echo flies along, and would push the vehicle about for ever.
OWN_SHARE = 0.8
# Ground that has risen less above where the vehicle was armed is the floor's business, m: a point has the hull's
# clearance, the floor its own.
RISEN = 0.3
# An echo so little before a plane is one of the same surface: sensors measure to some centimetres, and a bearing is
# known to half a sector, by which the plane may be turned; m, and a share of the echo's distance.
_ROUGH, _TURNED = 0.05, sin(0.5 * tau / RING_SECTORS)
# Echoes of one surface: so far beside each other, m, leaning by no more than a share of that; and at least so many.
_BESIDE, _LEAN, _FEWEST = 0.5, 0.3, 4
_SECTOR = tau / RING_SECTORS


class Seen(NamedTuple):
    """Distances from the vehicle's middle, m: infinite where there is nothing, NaN where it is not known.

    Attributes:
        ring: `RING_SECTORS` of them, counter-clockwise from forward.
        below, above: Straight down and up.
    """

    ring: Sequence[float]
    below: float
    above: float


class Echoes(NamedTuple):
    """What is there, world, m.

    Attributes:
        around: [x, y] of each thing.
        ground, ceiling: Height below which and above which the vehicle cannot go; None where none is seen.
    """

    around: tuple[tuple[float, float], ...] = ()
    ground: float | None = None
    ceiling: float | None = None


def echoes(seen: Seen, pose: Vector4, radius: float) -> Echoes:
    """Return where the measured things are: those that are in reach and not the vehicle itself.

    Args:
        seen: What the sensors measured.
        pose: Where the vehicle was then, world, m and rad.
        radius: Of its hull, m.
    """
    own = OWN_SHARE * radius
    x, y, z, yaw = pose
    around = tuple(
        (x + distance * cos(yaw + sector * _SECTOR), y + distance * sin(yaw + sector * _SECTOR))
        for sector, distance in enumerate(seen.ring)
        if own <= distance <= REACH
    )
    ground, ceiling = z - seen.below, z + seen.above
    return Echoes(
        around,
        ground if own <= seen.below <= REACH and ground > RISEN else None,
        ceiling if own <= seen.above <= REACH else None,
    )


def bounding(found: Echoes, at: Vector3) -> tuple[Vector3, ...]:
    """Return the points that matter to a vehicle at a place, the nearest first, `MOST_POINTS` at most; world, m.

    What was seen around is taken to reach up and down to the vehicle's height, ground and ceiling to go on to where
    it is: else the guard would have it dive under a point of a wall.

    Args:
        found: What was seen.
        at: The place, world, m.
    """
    x, y, z = at
    points = [(distance, (u, v, z)) for distance, u, v in _around(found.around, x, y)]
    if found.ground is not None:
        points.append((z - found.ground, (x, y, found.ground)))
    if found.ceiling is not None:
        points.append((found.ceiling - z, (x, y, found.ceiling)))
    return tuple(point for _, point in sorted(points)[:MOST_POINTS])


def _around(found: Sequence[tuple[float, float]], x: float, y: float) -> list[tuple[float, float, float]]:
    """Return distance and place of the points whose planes leave no echo on the near side of all of them."""
    near = sorted((hypot(u - x, v - y), u - x, v - y) for u, v in found)
    chosen: list[tuple[float, float, float]] = []
    for distance, a, b in near:
        slack = _ROUGH + _TURNED * distance
        if all(a * u + b * v < away - slack for away, u, v in chosen):
            chosen.append((distance, *_way_to(near, distance, a, b)))
            if len(chosen) == MOST_POINTS:
                break
    return [(distance, x + distance * u, y + distance * v) for distance, u, v in chosen]


def _way_to(
    near: list[tuple[float, float, float]], distance: float, a: float, b: float
) -> tuple[float, float]:
    """Return the unit vector to the surface that an echo is of, by a line through the echoes beside it.

    One echo's noise of δ turns the way to it by √(2 δ / distance), 9° for a centimetre at 0.8 m: what the guard lets
    pass along a wall would jump with every look.
    """
    u, v = a / distance, b / distance
    count, sum_l, sum_d, sum_ll, sum_ld = 0, 0.0, 0.0, 0.0, 0.0
    for away, p, q in near:
        if away > distance + _BESIDE:
            break
        depth, along = p * u + q * v - distance, q * u - p * v
        if abs(along) <= _BESIDE and abs(depth) <= _ROUGH + _LEAN * abs(along):
            count += 1
            sum_l += along
            sum_d += depth
            sum_ll += along * along
            sum_ld += along * depth
    spread = count * sum_ll - sum_l * sum_l
    if count < _FEWEST or spread <= 0.0:
        return u, v
    slope = (count * sum_ld - sum_l * sum_d) / spread
    length = hypot(1.0, slope)
    return (u + slope * v) / length, (v - slope * u) / length
