"""Whether a mission can be flown: room along the way, gates on it, fence and floor, time, wind, what it needs.

A file that loads can still ask for what no hand can do. Each fault is a sentence for whoever wrote the mission.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from groundstation.config import Settings
from groundstation.training.curriculum import circle
from groundstation.training.director import Director
from groundstation.training.events import GustNow, WindChange
from groundstation.training.mission import Fence, Mission
from sim.airframe import Airframe
from sim.environment.field import Field, Floats
from sim.environment.shapes import flown_through
from sim.environment.world import World
from sim.scenario import Gate, Obstacle, Point

# The way is looked at in steps of this length, so a clearance is known to half of it, m.
_STEP_M = 0.02


def faults(mission: Mission, airframe: Airframe, margin: float | None = None) -> list[str]:
    """Return what keeps a mission from being flown or from being worth it, a sentence each.

    Args:
        mission: As loaded.
        airframe: That flies it.
        margin: Kept between hull and obstacles, m; without it the guard's own.
    """
    margin = Settings().shield.margin if margin is None else margin
    found = [*_too_narrow(mission, airframe, margin), *_gates_beside(mission)]
    found += [*_out_of_bounds(mission, airframe.radius), *_criteria(mission, airframe)]
    found += _too_windy(mission, airframe)
    if mission.judged and _flies_itself(mission):
        found.append("a hand that does nothing passes it: move a point away from where take-off ends.")
    return found


def misplaced(mission: Mission, known: Mapping[str, Mission]) -> list[str]:
    """Return what is wrong with a mission's place among others: needs that do not exist, or lead nowhere.

    Args:
        mission: As loaded.
        known: All there are, by name.
    """
    unknown = [name for name in mission.needs if name not in known and name != mission.name]
    found = [f"needs: there is no mission {name!r}; pass it over or write it." for name in unknown]
    needs = {name: other.needs for name, other in known.items()} | {mission.name: mission.needs}
    if circle(mission.name, needs):
        found.append("needs: it leads back to this mission, so nobody can ever fly it.")
    found += [
        f"needs: {name!r} is of level {known[name].level}, above this mission's {mission.level}."
        for name in mission.needs
        if name in known and known[name].level > mission.level
    ]
    return found


def clearance(mission: Mission, obstacles: Sequence[Obstacle] | None = None) -> float:
    """Return how near the middle of the vehicle comes to an obstacle on its straight way, m; infinite without any.

    Args:
        mission: Its way from the ground to the ground.
        obstacles: Those that count; without them all.
    """
    world = World(mission.obstacle if obstacles is None else obstacles)
    return float(Field(world).distance(_samples(_whole_way(mission))).min())


def length(mission: Mission) -> float:
    """Return the length of the straight way from the ground to the ground, m."""
    return sum(math.dist(*leg) for leg in pairwise(_whole_way(mission)))


def holds(mission: Mission) -> list[float]:
    """Return how long the vehicle must stay at each point and at the target, s."""
    return [each.hold_s for each in (*mission.waypoints, *([mission.target] if mission.target else []))]


def _whole_way(mission: Mission) -> list[Point]:
    """Return the points from the pad through the path and straight down."""
    x, y, _ = mission.path[-1]
    pad = mission.landing_pad
    return [(0.0, 0.0, 0.0), *mission.path, pad.position if pad else (x, y, 0.0)]


def _samples(points: Sequence[Point]) -> Floats:
    """Return points all along a line, shape (n, 3), m."""
    rows = [
        np.linspace(start, end, max(math.ceil(math.dist(start, end) / _STEP_M), 1) + 1)
        for start, end in pairwise(points)
    ]
    return np.concatenate(rows)


def _too_narrow(mission: Mission, airframe: Airframe, margin: float) -> Iterator[str]:
    if not mission.judged:
        return
    needed = airframe.radius + max(margin, mission.criteria.min_clearance_m)
    for obstacle in mission.obstacle:
        room = clearance(mission, [obstacle])
        if room < needed:
            yield (
                f"the way comes to {max(room, 0.0):.2f} m of {obstacle.name!r}, and {airframe.name} needs "
                f"{needed:.2f} m (hull and margin): move the point or the obstacle."
            )


def _gates_beside(mission: Mission) -> Iterator[str]:
    for gate in (each for each in mission.obstacle if isinstance(each, Gate)):
        if mission.judged and not any(flown_through(gate, *leg) for leg in pairwise(mission.path)):
            yield f"the way does not lead through gate {gate.name!r}: put a point into its middle."


def _out_of_bounds(mission: Mission, radius: float) -> Iterator[str]:
    shield = Settings().shield
    fence = mission.fence or Fence(shield.fence, shield.ceiling, shield.floor)
    for x, y, z in mission.path:
        if fence.radius and math.hypot(x, y) + radius > fence.radius:
            yield f"the point {_said((x, y, z))} is not inside the fence, hull included."
        if z < fence.floor:
            yield f"the point {_said((x, y, z))} is below the guard's floor of {fence.floor:g} m."
        if fence.ceiling and z > fence.ceiling:
            yield f"the point {_said((x, y, z))} is above the ceiling of {fence.ceiling:g} m."


def _criteria(mission: Mission, airframe: Airframe) -> Iterator[str]:
    limit, target = mission.criteria.time_limit_s, mission.target
    quickest = sum(holds(mission)) + length(mission) / min(
        airframe.horizontal_speed, Settings().limits.horizontal_speed
    )
    if mission.judged and quickest > limit:
        yield f"it takes {quickest:.0f} s at full speed, and criteria.time_limit_s is {limit:g} s: give more."
    if target and mission.criteria.final_error_m > target.radius:
        yield (
            f"criteria.final_error_m, {mission.criteria.final_error_m:g} m, is more than target.radius, "
            f"{target.radius:g} m, so it can never be missed: lower it."
        )


def _too_windy(mission: Mission, airframe: Airframe) -> Iterator[str]:
    winds = [mission.wind.mean, *(event.velocity for event in mission.event if isinstance(event, WindChange))]
    gusts = [*mission.wind.gust, *(event for event in mission.event if isinstance(event, GustNow))]
    winds += [gust.velocity for gust in gusts]
    strongest = max(math.hypot(*wind) for wind in winds)
    if strongest > airframe.horizontal_speed:
        yield (
            f"the wind of {strongest:.1f} m/s is more than {airframe.name} flies at most, "
            f"{airframe.horizontal_speed:g} m/s: nobody can hold against it."
        )


def _flies_itself(mission: Mission) -> bool:
    """Say whether a vehicle that takes off, stays as long as it is asked to, and lands meets the criteria."""
    director = Director(mission, World(), 0.0)
    x, y, z = mission.path[0]
    yaw = math.radians(mission.vehicle.yaw_deg)
    # Twice: once to come to the point, once to have stayed there.
    for t in [0.0, *np.cumsum(np.repeat(holds(mission), 2) + 0.1).tolist()]:
        director.vehicle(t, (x, y, z, yaw), in_air=True, armed=True)
    director.vehicle(director.figures.duration, (x, y, 0.0, yaw), in_air=False, armed=False)
    return not director.shortcomings()


def _said(point: Point) -> str:
    return f"[{', '.join(f'{part:g}' for part in point)}]"
