"""The autopilot's own flying: hold, take off, return, land, and following an offboard setpoint; one target at a time.

World ENU, vehicle FLU, SI units. Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from math import hypot

from sim.airframe import Airframe
from sim.autopilot.guidance import FREE, Guidance, Target
from sim.autopilot.parameters import Parameters
from sim.kinematics import ZERO3, ZERO4, Vector3, Vector4, world_rates
from sim.models.motion import Motion

_TAKEOFF_DONE_M = 0.15
_WAYPOINT_M = 0.5
# Land slows from cruising descent to landing speed between these heights (MPC_LAND_ALT1, MPC_LAND_ALT2).
_LAND_SLOWING_M = (10.0, 5.0)


class Mode(Enum):
    """Who or what steers."""

    HOLD = "Hold"
    TAKEOFF = "Takeoff"
    OFFBOARD = "Offboard"
    RETURN = "Return"
    LAND = "Land"


class Navigator:
    """Steers in every mode.

    Args:
        airframe: The vehicle's limits.
        motion: The model it steers by.
        parameters: Gains, speeds and heights.
        start: Where the vehicle stands, and home until it is armed.
    """

    def __init__(self, airframe: Airframe, motion: Motion, parameters: Parameters, start: Vector4) -> None:
        self.mode = Mode.HOLD
        self.home = start
        self.target = Target((start[0], start[1], start[2]), yaw=start[3])
        self.setpoint = Target(FREE)
        self.takeoff_height: float | None = None
        self._parameters = parameters
        self._guidance = Guidance(motion, airframe, parameters)
        self._p, self._v = start, ZERO4
        self._height = start[2]
        self._climbed = self._descending = False
        self._enter: dict[Mode, Callable[[], None]] = {
            Mode.HOLD: self._enter_hold,
            Mode.TAKEOFF: self._enter_takeoff,
            Mode.OFFBOARD: self._guidance.restart,
            Mode.RETURN: self._enter_return,
            Mode.LAND: self._enter_land,
        }
        self._steer: dict[Mode, Callable[[float], Vector4]] = {
            Mode.HOLD: self._to_target,
            Mode.TAKEOFF: self._climb,
            Mode.OFFBOARD: self._follow,
            Mode.RETURN: self._return,
            Mode.LAND: self._descend,
        }

    def look(self, p: Vector4, v: Vector4) -> None:
        """Take in where the vehicle is and its velocities."""
        self._p, self._v = p, v

    def enter(self, mode: Mode) -> None:
        """Begin a mode from here."""
        self.mode = mode
        self._enter[mode]()

    def go_to(self, position: Vector3, yaw: float | None) -> None:
        """Hold at another point, keeping the yaw unless one is given."""
        self.enter(Mode.HOLD)
        self.target = Target(position, yaw=self._p[3] if yaw is None else yaw)

    def steer(self, dt: float) -> Vector4:
        """Return the reference for the vehicle."""
        return self._steer[self.mode](dt)

    def _enter_hold(self) -> None:
        """Hold where the vehicle comes to rest when it brakes with MPC_ACC_HOR: v²/2a ahead."""
        self._guidance.restart()
        x, y, z, yaw = self._p
        vx, vy, _, _ = world_rates(yaw, self._v)
        ahead = hypot(vx, vy) / (2.0 * self._parameters["MPC_ACC_HOR"])
        self.target = Target((x + ahead * vx, y + ahead * vy, z), yaw=yaw)

    def _enter_takeoff(self) -> None:
        """Climb to a height above home; no lower than now."""
        self._guidance.restart()
        x, y, z, yaw = self._p
        above = self._parameters["MIS_TAKEOFF_ALT"] if self.takeoff_height is None else self.takeoff_height
        self._height = max(z, self.home[2] + above)
        self.target = Target((x, y, None), yaw=yaw)

    def _enter_land(self) -> None:
        self._enter_hold()
        x, y, _ = self.target.position
        self.target = self.target._replace(position=(x, y, None))

    def _enter_return(self) -> None:
        """Return at RTL_RETURN_ALT, or lower when near: within a cone of 45° over home (RTL_CONE_ANG)."""
        self._enter_hold()
        x, y, z, _ = self._p
        away = hypot(x - self.home[0], y - self.home[1])
        self._height = max(z, self.home[2] + min(self._parameters["RTL_RETURN_ALT"], away))
        self.target = self.target._replace(position=(*self.target.position[:2], self._height))
        self._climbed = self._descending = False

    def _to_target(self, dt: float) -> Vector4:
        return self._guidance.track(self._p, self._v, self.target, dt, self._parameters["MPC_XY_CRUISE"])

    def _climb(self, dt: float) -> Vector4:
        x, y, _ = self.target.position
        left = self._height - self._p[2]
        if left < _TAKEOFF_DONE_M:
            self.mode = Mode.HOLD
            self.takeoff_height = None
            self.target = self.target._replace(position=(x, y, self._height), velocity=ZERO3)
        else:
            up = min(self._parameters["MPC_TKO_SPEED"], self._parameters["MPC_Z_P"] * left)
            self.target = self.target._replace(velocity=(0.0, 0.0, up))
        return self._to_target(dt)

    def _descend(self, dt: float) -> Vector4:
        slow, fast = self._parameters["MPC_LAND_SPEED"], self._parameters["MPC_Z_VEL_MAX_DN"]
        high, low = _LAND_SLOWING_M
        share = max(0.0, min(1.0, (self._p[2] - self.home[2] - low) / (high - low)))
        down = slow + share * max(0.0, fast - slow)
        self.target = self.target._replace(velocity=(0.0, 0.0, -down))
        return self._to_target(dt)

    def _return(self, dt: float) -> Vector4:
        """Climb, cruise home, then land there."""
        if self._descending:
            return self._descend(dt)
        x, y, _, _ = self._p
        home_x, home_y, _, _ = self.home
        if not self._climbed and self._height - self._p[2] < _WAYPOINT_M:
            self._climbed = True
            self.target = self.target._replace(position=(home_x, home_y, self._height))
        elif self._climbed and hypot(home_x - x, home_y - y) < _WAYPOINT_M:
            self._descending = True
            self.target = self.target._replace(position=(home_x, home_y, None))
        return self._to_target(dt)

    def _follow(self, dt: float) -> Vector4:
        if self.setpoint.position == FREE:
            return self._guidance.velocity(self._p, self.setpoint)
        return self._guidance.track(self._p, self._v, self.setpoint, dt)
