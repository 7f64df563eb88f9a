"""Return: where to, how high, and the stages of the way there. World ENU, SI units.

Source: PX4 user guide, "Return Mode"; names in capitals are PX4's parameters.
"""

from __future__ import annotations

from math import hypot, inf, radians, tan
from typing import NamedTuple

from sim.autopilot.flight import Flight
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Action, Plan
from sim.autopilot.stages import GoTo, Stage, Touchdown, Wait
from sim.kinematics import Vector3

# It does not sink before it is as near as this.
_OVER_M = 0.5


class Destination(NamedTuple):
    """Where a return ends: the ground there, world, m, and the yaw to land with, rad, or None."""

    position: Vector3
    yaw: float | None


def destination(flight: Flight, plan: Plan) -> Destination:
    """Return the nearest of the places RTL_TYPE admits, seen from above.

    0: home and the rally points; 1: the mission's landing and the rally points, and home only without them; 3: all.
    """
    kind = flight.parameters["RTL_TYPE"]
    home = Destination(flight.home[:3], flight.home[3])
    places = [Destination(point, None) for point in plan.rally]
    if kind != 0 and (landing := _mission_landing(flight, plan)):
        places.append(landing)
    if kind != 1 or not places:
        places.insert(0, home)
    x, y, _, _ = flight.p
    return min(places, key=lambda place: hypot(place.position[0] - x, place.position[1] - y))


def _mission_landing(flight: Flight, plan: Plan) -> Destination | None:
    for leg in plan.mission:
        x, y, z = leg.position
        if leg.action is Action.LAND and x is not None and y is not None:
            ground = (z or 0.0) + (flight.home[2] if leg.above_home else 0.0)
            return Destination((x, y, ground), leg.yaw)
    return None


def return_height(parameters: Parameters, away: float) -> float:
    """Return how high over the destination to fly there from a horizontal distance `away`, m.

    RTL_RETURN_ALT; nearer than RTL_MIN_DIST a cone of half-angle RTL_CONE_ANG over the destination is high enough,
    but twice the acceptance radius at least, and twice the distance within that radius.
    """
    height, near = parameters["RTL_RETURN_ALT"], parameters["NAV_ACC_RAD"]
    angle = parameters["RTL_CONE_ANG"]
    if away <= near:
        return 2.0 * away
    if away <= parameters["RTL_MIN_DIST"] and angle > 0.0:
        height = min(height, away / tan(radians(max(1.0, min(89.0, angle)))))
    return max(height, 2.0 * near)


def stages_home(flight: Flight, plan: Plan) -> tuple[Stage, ...]:
    """Return the way back: up, across, down to RTL_DESCEND_ALT, a wait of RTL_LAND_DELAY, and the landing.

    With a negative delay it stays in the air there.
    """
    get = flight.parameters
    (x, y, ground), yaw = destination(flight, plan)
    away = hypot(x - flight.p[0], y - flight.p[1])
    over = return_height(get, away)
    height = max(flight.p[2], ground + over)
    lower = min(height, ground + get["RTL_DESCEND_ALT"])
    delay = get["RTL_LAND_DELAY"]
    near = min(_OVER_M, get["NAV_ACC_RAD"])
    there: tuple[Stage, ...] = (
        GoTo((None, None, height), radius=inf),
        GoTo((x, y, height), radius=near),
        GoTo((x, y, lower), radius=near, yaw=yaw),
    )
    if delay < 0.0:
        return (*there, Wait())
    return (*there, Wait(delay), Touchdown(ground, yaw))
