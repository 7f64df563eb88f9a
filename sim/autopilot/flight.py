"""What all flight modes share: where the vehicle is, where home is, and steering to one target at a time.

World ENU, vehicle FLU, SI units. Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from math import atan2, hypot

from sim.autopilot.guidance import Guidance, Speeds, Target, braking
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Free3
from sim.kinematics import ZERO4, Vector4, world_rates

_MOVES = 0.5


class Flight:
    """The vehicle as the modes see it.

    Args:
        guidance: How it steers.
        parameters: Gains, speeds and heights.
        start: Where it stands.

    Attributes:
        p: Where it is, as far as it knows.
        v: Its velocities, likewise.
        landed: It stands on something.
        home: Where it returns to.
        target: Where it shall be.
        cruise: Horizontal speed asked for in flight, m/s; None: MPC_XY_CRUISE.
    """

    def __init__(self, guidance: Guidance, parameters: Parameters, start: Vector4) -> None:
        self.guidance = guidance
        self.parameters = parameters
        self.p, self.v = start, ZERO4
        self.landed = True
        self.home = start
        self.cruise: float | None = None
        self.target = Target((start[0], start[1], start[2]), yaw=start[3])

    def hold(self) -> None:
        """Hold where the vehicle comes to rest when it brakes with MPC_ACC_HOR."""
        self.guidance.restart()
        x, y, z, yaw = self.p
        ahead_x, ahead_y = self.ahead()
        self.target = Target((x + ahead_x, y + ahead_y, z), yaw=yaw)

    def ahead(self) -> tuple[float, float]:
        """Return the way the vehicle would take to brake, world x and y, m."""
        vx, vy, _, _ = world_rates(self.p[3], self.v)
        speed = hypot(vx, vy)
        if speed == 0.0:
            return 0.0, 0.0
        way = braking(speed, self.parameters["MPC_ACC_HOR"]) / speed
        return way * vx, way * vy

    def aim(self, position: Free3, yaw: float | None = None, velocity: Free3 = (None, None, None)) -> None:
        """Set the target; without a yaw it stays as it was asked for last."""
        self.target = Target(position, velocity, self.target.yaw if yaw is None else yaw)

    def steer(self, dt: float) -> Vector4:
        """Return the reference toward the target."""
        return self.guidance.track(self.p, self.v, self.target, dt, self.speeds)

    @property
    def speeds(self) -> Speeds:
        """The fastest it flies on its own."""
        auto = self.guidance.auto
        if self.cruise is None:
            return auto
        return auto._replace(horizontal=min(self.guidance.full.horizontal, self.cruise))

    def above_home(self, height: float) -> float:
        """Turn a height above home into the world's, m."""
        return self.home[2] + height

    def heading(self, x: float, y: float, near: float) -> float | None:
        """Return the yaw MPC_YAW_MODE wants on the way to a point, rad, or None to keep it.

        0 toward the point, until it is nearer than `near`; 1 toward home; 2 away from home; 3 along the way.
        """
        mode = self.parameters["MPC_YAW_MODE"]
        if mode == 3:
            east, north, _, _ = world_rates(self.p[3], self.v)
            near = _MOVES
        elif mode == 0:
            east, north = x - self.p[0], y - self.p[1]
        else:
            sign = 1.0 if mode == 1 else -1.0
            east, north = sign * (self.home[0] - self.p[0]), sign * (self.home[1] - self.p[1])
        return atan2(north, east) if hypot(east, north) > near else None
