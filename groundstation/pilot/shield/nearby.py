"""What is near the vehicle, as distance and way out: obstacles, what its sensors see, floor, ceiling and fence.

Every thing is kept away from by a half-space: all obstacles are convex and their distance is exact, so no point of
one lies on the near side of the plane through its nearest point. World ENU, m.
"""

from __future__ import annotations

from math import dist, hypot, inf
from typing import NamedTuple

from drivers.device import Vector3
from groundstation import config
from groundstation.pilot.surroundings import Surroundings
from groundstation.training.mission import Fence
from sim.environment.world import Solid, World

# Candidates are looked up anew when the vehicle has moved so far, m.
_MOVED_M = 1.0
# Within this way, m, everything is as near as it was: a fiftieth of the margin.
_SAME_M = 0.005
_FURTHER = 1.1
# What is seen so near to a known obstacle is that obstacle, m: less than the margin, for something may lean on it.
_SAME_THING_M = 0.15
_SEEN = "sensor"
_FAR = (inf, inf, inf)


class Near(NamedTuple):
    """Something near.

    Attributes:
        gap: From the hull to it, m; negative within.
        normal: Unit vector away from it.
        name: The obstacle's, or "floor", "ceiling", "fence", "sensor".
        solid: It can be run into; the bounds of the space that one may fly in cannot.
    """

    gap: float
    normal: Vector3
    name: str
    solid: bool


class Candidates(NamedTuple):
    """What need not be measured anew at every tick.

    Attributes:
        at: Where the solids were measured, world, m.
        solids: All of them with their distance there, nearest first.
        looked: Where one last looked, m; with what was seen, and how far.
        seen: See `looked`.
        unknown: Of what was seen, that which no known obstacle explains.
        reach: See `looked`.
        near: What was found there.
    """

    at: Vector3 = _FAR
    solids: tuple[tuple[float, Solid], ...] = ()
    looked: Vector3 = _FAR
    seen: tuple[Vector3, ...] = ()
    unknown: tuple[Vector3, ...] = ()
    reach: float = 0.0
    near: tuple[Near, ...] = ()


class Neighbourhood:
    """Finds what is near.

    Args:
        surroundings: Obstacles and the vehicle's size.
        shield: Floor, ceiling, fence where the mission has no fence.
    """

    def __init__(self, surroundings: Surroundings, shield: config.Shield) -> None:
        self._solids = World(surroundings.obstacles).solids
        self._radius = surroundings.radius
        # A mission's fence stands in place of the settings'.
        fence = surroundings.fence or Fence(shield.fence, shield.ceiling, shield.floor)
        self._fence, self._ceiling, self._floor = fence.radius, fence.ceiling, fence.floor

    def look(
        self, candidates: Candidates, point: Vector3, seen: tuple[Vector3, ...], reach: float
    ) -> tuple[Candidates, tuple[Near, ...]]:
        """Return what is near a point, and the candidates for the next look.

        Args:
            candidates: Of the look before.
            point: The vehicle's middle, world, m.
            seen: Points on obstacles that the vehicle's sensors see, world, m.
            reach: Up to which gap a thing is near, m.
        """
        known = candidates
        if dist(point, known.looked) < _SAME_M and reach <= known.reach and seen == known.seen:
            return known, known.near
        x, y, z = point
        solids, at, moved = known.solids, known.at, dist(point, known.at)
        if moved > _MOVED_M:
            solids, at, moved = self._measured(point), point, 0.0
        # A little further than asked for, so that a speed that grows is no reason to look again.
        reach = _FURTHER * reach
        within = reach + self._radius
        found: list[Near] = []
        for before, solid in solids:
            # No distance changes faster than the vehicle moves; those that follow are further still.
            if before - moved >= within:
                break
            distance = solid.distance(x, y, z)
            if distance < within:
                found.append(Near(distance - self._radius, solid.normal(x, y, z), solid.name, solid=True))
        unknown = known.unknown if seen == known.seen else self._unknown(seen)
        for at in unknown:
            distance = dist(point, at)
            if 0.0 < distance < within:
                away = ((x - at[0]) / distance, (y - at[1]) / distance, (z - at[2]) / distance)
                found.append(Near(distance - self._radius, away, _SEEN, solid=True))
        self._bounds(found, point, reach)
        near = tuple(found)
        return Candidates(at, solids, point, seen, unknown, reach, near), near

    def _unknown(self, seen: tuple[Vector3, ...]) -> tuple[Vector3, ...]:
        """Return the points that lie on no known obstacle: what is known is kept away from by its exact distance."""
        return tuple(
            at for at in seen if not any(solid.distance(*at) < _SAME_THING_M for solid in self._solids)
        )

    def _measured(self, point: Vector3) -> tuple[tuple[float, Solid], ...]:
        measured = ((solid.distance(*point), solid) for solid in self._solids)
        return tuple(sorted(measured, key=_first))

    def _bounds(self, found: list[Near], point: Vector3, reach: float) -> None:
        """Add the bounds of the space to fly in. They hold for the vehicle's middle, the fence for its hull."""
        x, y, z = point
        if z - self._floor < reach:
            found.append(Near(z - self._floor, (0.0, 0.0, 1.0), "floor", solid=False))
        if self._ceiling and self._ceiling - z < reach:
            found.append(Near(self._ceiling - z, (0.0, 0.0, -1.0), "ceiling", solid=False))
        if self._fence:
            away = hypot(x, y)
            gap = self._fence - away - self._radius
            if gap < reach and away > 0.0:
                found.append(Near(gap, (-x / away, -y / away, 0.0), "fence", solid=False))


def nearest(near: tuple[Near, ...]) -> Near | None:
    """Return the nearest thing that can be run into."""
    found: Near | None = None
    for thing in near:
        if thing.solid and (found is None or thing.gap < found.gap):
            found = thing
    return found


def _first(measured: tuple[float, Solid]) -> float:
    return measured[0]
