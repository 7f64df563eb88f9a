"""Flying a mission: leg after leg, each made of stages. World ENU, SI units.

Source: PX4 user guide, "Mission Mode" and "Mission commands"; names in capitals are PX4's parameters.
"""

from __future__ import annotations

from collections import deque
from math import hypot

from sim.autopilot.fence import breach
from sim.autopilot.flight import Flight
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Action, Leg, Plan
from sim.autopilot.stages import Climb, GoTo, Stage, Touchdown, Wait
from sim.kinematics import Vector4

_GOES = (Action.WAYPOINT, Action.LOITER, Action.LOITER_TIME)
_NAVIGATES = (*_GOES, Action.TAKEOFF, Action.LAND, Action.RETURN)


class Mission:
    """The mission on board, and how far it has come.

    Args:
        flight: The vehicle.

    Attributes:
        legs: As loaded.
        index: The leg being flown, or to begin with.
        reached: The last leg completed, or −1.
        reached_count: How many have been, jumps counted each time.
        finished: The last leg is done.
        wants_return: A leg asks for Return mode.
    """

    def __init__(self, flight: Flight) -> None:
        self._flight = flight
        self._stages: deque[Stage] = deque()
        self._jumps: dict[int, int] = {}
        self._begun = False
        self.legs: tuple[Leg, ...] = ()
        self.index = 0
        self.reached = -1
        self.reached_count = 0
        self.finished = self.wants_return = False

    def load(self, legs: tuple[Leg, ...]) -> None:
        """Take another mission, from its first leg."""
        self.legs = legs
        self.index, self.reached = 0, -1
        self._restart()

    def go_to(self, index: int) -> None:
        """Go on with another leg."""
        self.index = index
        self._restart()

    def begin(self) -> None:
        """Begin, or go on where it was left; after the end, from the first leg."""
        if self.finished:
            self.index, self.reached = 0, -1
            self._jumps.clear()
        self._restart()

    def update(self, dt: float) -> None:
        """Fly on by a step; at most one leg is done in it."""
        if self.finished or self.wants_return or not self.legs:
            return
        if not self._begun:
            self._begun = True
            self._stages = deque(stages_of(self.legs[self.index], self._flight))
        if self._stages and self._stages[0].update(self._flight, dt):
            self._stages.popleft()
        if not self._stages:
            self._complete(self.legs[self.index])

    def _restart(self) -> None:
        self._begun = self.finished = self.wants_return = False

    def _complete(self, leg: Leg) -> None:
        self.reached = self.index
        self.reached_count += 1
        following = self.index + 1
        if leg.action is Action.CHANGE_SPEED:
            self._flight.cruise = leg.value if leg.value > 0.0 else None
        elif leg.action is Action.RETURN:
            self.wants_return = True
        elif leg.action is Action.JUMP and self._jumps.get(self.index, 0) < leg.repeat:
            self._jumps[self.index] = self._jumps.get(self.index, 0) + 1
            following = int(leg.value)
        if following >= len(self.legs):
            self.finished = True
            self._flight.cruise = None
        else:
            self.index = following
            self._begun = False


def stages_of(leg: Leg, flight: Flight) -> list[Stage]:
    """Return what a leg is made of, from where the vehicle is.

    On the ground the way to a waypoint begins with a climb to its height, or to MIS_TAKEOFF_ALT if that is more.
    """
    x, y, z = leg.position
    if z is not None and leg.above_home:
        z = flight.above_home(z)
    stages: list[Stage] = []
    if leg.action in (*_GOES, Action.TAKEOFF):
        if flight.landed or leg.action is Action.TAKEOFF:
            least = flight.above_home(flight.parameters["MIS_TAKEOFF_ALT"])
            stages.append(Climb(_climb_to(z, least, takeoff=leg.action is Action.TAKEOFF)))
        stages.append(GoTo((x, y, z), leg.radius, leg.yaw))
        if leg.action is Action.LOITER:
            stages.append(Wait())
        elif leg.hold_s > 0.0:
            stages.append(Wait(leg.hold_s))
    elif leg.action is Action.LAND:
        ground = flight.home[2] if z is None else z
        if x is not None and y is not None:
            stages.append(GoTo((x, y, None), min(0.5, flight.parameters["NAV_ACC_RAD"]), leg.yaw))
        stages.append(Touchdown(ground, leg.yaw))
    elif leg.action is Action.DELAY:
        stages.append(Wait(leg.hold_s))
    return stages


def _climb_to(z: float | None, least: float, *, takeoff: bool) -> float:
    if z is None:
        return least
    return z if takeoff else max(z, least)


def mission_fault(plan: Plan, home: Vector4, parameters: Parameters) -> str:
    """Return why a mission cannot be flown, or "": no place in it, or one out of the fence.

    MIS_TKO_LAND_REQ may require more: 1 a take-off, 2 a landing, 3 both, 4 both or neither.
    """
    if not any(leg.action in _NAVIGATES for leg in plan.mission):
        return "it has no place to fly to" if plan.mission else "no mission is on board"
    for index, leg in enumerate(plan.mission):
        x, y, z = leg.position
        if x is None or y is None or leg.action is Action.LAND:
            continue
        height = home[2] if z is None else z + (home[2] if leg.above_home else 0.0)
        if parameters["GF_ACTION"] and (why := breach((x, y, height), home, plan.fence, parameters)):
            return f"item {index + 1} is {why}"
    return _requirement_fault(plan.mission, int(parameters["MIS_TKO_LAND_REQ"]))


def jump_fault(legs: tuple[Leg, ...]) -> str:
    """Return which item of a mission jumps to one that is not there, in words, or ""."""
    for index, leg in enumerate(legs):
        if leg.action is Action.JUMP and not 0 <= int(leg.value) < len(legs):
            return f"item {index + 1} jumps to an item that is not there"
    return ""


def first_waypoint_distance(legs: tuple[Leg, ...], home: Vector4) -> float:
    """Return how far from home the first place is, seen from above, m; 0 without any."""
    for leg in legs:
        x, y, _ = leg.position
        if leg.action in _NAVIGATES and x is not None and y is not None:
            return hypot(x - home[0], y - home[1])
    return 0.0


def _requirement_fault(legs: tuple[Leg, ...], requirement: int) -> str:
    first = next(leg.action for leg in legs if leg.action in _NAVIGATES)
    takes_off = first is Action.TAKEOFF
    lands = any(leg.action in (Action.LAND, Action.RETURN) for leg in legs)
    if (requirement in (1, 3) and not takes_off) or (requirement == 4 and lands and not takes_off):
        return "a take-off is required as its first place (MIS_TKO_LAND_REQ)"
    if (requirement in (2, 3) and not lands) or (requirement == 4 and takes_off and not lands):
        return "a landing is required (MIS_TKO_LAND_REQ)"
    return ""
