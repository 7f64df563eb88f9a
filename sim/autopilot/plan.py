"""What a ground station may plan: a mission's legs, a fence, rally points. World ENU; metres, seconds, radians."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from sim.kinematics import Vector3

Free3 = tuple[float | None, float | None, float | None]
FREE: Free3 = (None, None, None)
Point2 = tuple[float, float]


class Action(Enum):
    """What a leg asks for, by the name shown to the operator."""

    WAYPOINT = "Waypoint"
    TAKEOFF = "Takeoff"
    LAND = "Land"
    RETURN = "Return"
    LOITER = "Loiter"
    LOITER_TIME = "Loiter time"
    DELAY = "Delay"
    CHANGE_SPEED = "Change speed"
    JUMP = "Jump"
    # Heard, stored and passed over, as PX4 does with a camera it has not: triggers, gimbals, regions of interest.
    NOTHING = "Nothing"


class Leg(NamedTuple):
    """One item of a mission.

    Attributes:
        action: What it asks for.
        position: Where, world, m, by axis; None stays as it is when the leg begins.
        above_home: The height counts from home, wherever that is in flight; otherwise from the world's z = 0.
        yaw: World, rad; None: as MPC_YAW_MODE says, nose toward the waypoint by default.
        hold_s: How long to stay (WAYPOINT, LOITER_TIME, DELAY), s.
        radius: How near counts as there, m; 0: NAV_ACC_RAD.
        value: CHANGE_SPEED: horizontal speed, m/s; JUMP: the index of the leg to go on with.
        repeat: JUMP: how many times.
    """

    action: Action
    position: Free3 = FREE
    above_home: bool = False
    yaw: float | None = None
    hold_s: float = 0.0
    radius: float = 0.0
    value: float = 0.0
    repeat: int = 0


class Polygon(NamedTuple):
    """A fence zone seen from above, of any height: stay inside (inclusion) or outside of it.

    Attributes:
        corners: Three or more, world x and y, m, in order.
        inclusion: Whether the vehicle must be inside.
    """

    corners: tuple[Point2, ...]
    inclusion: bool


class Circle(NamedTuple):
    """A round fence zone seen from above: `center` x and y and `radius`, m; see `Polygon` for `inclusion`."""

    center: Point2
    radius: float
    inclusion: bool


Zone = Polygon | Circle


class Plan(NamedTuple):
    """All that is on board.

    Attributes:
        mission: Its legs.
        fence: Its zones: outside of every exclusion, and inside at least one inclusion where there are any.
        rally: Points that a return may end at.
    """

    mission: tuple[Leg, ...] = ()
    fence: tuple[Zone, ...] = ()
    rally: tuple[Vector3, ...] = ()
