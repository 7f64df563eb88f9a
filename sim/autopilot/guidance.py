"""How the autopilot steers by itself: PX4's cascade, position to velocity to acceleration, on its own model.

World ENU, vehicle FLU; metres, seconds, radians. The gains are PX4's parameters of the same names.
"""

from __future__ import annotations

from math import cos, hypot, inf, radians, sin
from typing import NamedTuple

from sim.airframe import Airframe
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import FREE, Free3
from sim.kinematics import ZERO3, Vector3, Vector4, vehicle_rates, world_rates, wrap
from sim.models.motion import Motion

# How fast a yaw rate error is turned into angular acceleration, 1/s.
_YAW_RATE_GAIN = 5.0
# The most the integrator may hold, m/s², and the velocity error beyond which it waits, m/s: what it is there for is
# steady wind, not getting up to speed or braking.
_INTEGRAL_LIMIT = 3.0
_INTEGRATE_WITHIN = 0.5


class Target(NamedTuple):
    """Where to be and how to move there, world.

    Attributes:
        position: m, by axis; None is free, then the velocity steers that axis.
        velocity: m/s; with a position it is fed forward; None is none. An axis with neither stands still, unless it
            has an acceleration.
        yaw: rad, or None: then `yaw_rate` steers.
        yaw_rate: rad/s, counter-clockwise.
        acceleration: m/s²; with a position it is fed forward; an axis with nothing else integrates it to a velocity,
            from the one it had when the first such setpoint came.
    """

    position: Free3 = FREE
    velocity: Free3 = FREE
    yaw: float | None = None
    yaw_rate: float = 0.0
    acceleration: Free3 = FREE


class Speeds(NamedTuple):
    """Largest speeds: horizontal (norm), up and down, m/s, and about the vertical, rad/s."""

    horizontal: float
    up: float
    down: float
    turn: float

    def limited(self, velocity: Vector3) -> Vector3:
        """Cap a velocity."""
        x, y, z = velocity
        size = hypot(x, y)
        if size > self.horizontal:
            x, y = x * self.horizontal / size, y * self.horizontal / size
        return x, y, max(-self.down, min(self.up, z))


class _Gains(NamedTuple):
    xy: float
    z: float
    yaw: float
    xy_speed: float
    z_speed: float
    xy_integral: float
    z_integral: float
    acceleration: float


class Guidance:
    """Turns targets into references for the vehicle.

    Args:
        motion: The model of the vehicle.
        airframe: Its limits.
        parameters: Gains and limits.

    Attributes:
        full: The fastest there is, for offboard setpoints.
        auto: The fastest it flies on its own.
        manual: The fastest by the sticks.
    """

    full: Speeds
    auto: Speeds
    manual: Speeds
    _gains: _Gains

    def __init__(self, motion: Motion, airframe: Airframe, parameters: Parameters) -> None:
        self._motion = motion
        self._airframe = airframe
        self._parameters = parameters
        self._integral = ZERO3
        self._grown: Free3 = FREE
        self._read = -1
        self.refresh()

    def refresh(self) -> None:
        """Take in changed parameters."""
        get = self._parameters
        if get.changed == self._read:
            return
        self._read = get.changed
        frame = self._airframe
        turn = min(frame.yaw_rate, radians(get["MC_YAWRATE_MAX"]))
        horizontal = min(frame.horizontal_speed, get["MPC_XY_VEL_MAX"])
        up = min(frame.climb_speed, get["MPC_Z_VEL_MAX_UP"])
        down = min(frame.descent_speed, get["MPC_Z_VEL_MAX_DN"])
        self.full = Speeds(horizontal, up, down, turn)
        self.auto = Speeds(
            min(horizontal, get["MPC_XY_CRUISE"]),
            min(up, get["MPC_Z_V_AUTO_UP"]),
            min(down, get["MPC_Z_V_AUTO_DN"]),
            min(turn, radians(get["MPC_YAWRAUTO_MAX"])),
        )
        by_hand = min(turn, radians(get["MPC_MAN_Y_MAX"]))
        self.manual = Speeds(min(horizontal, get["MPC_VEL_MANUAL"]), up, down, by_hand)
        self._gains = _Gains(
            get["MPC_XY_P"],
            get["MPC_Z_P"],
            get["MC_YAW_P"],
            get["MPC_XY_VEL_P_ACC"],
            get["MPC_Z_VEL_P_ACC"],
            get["MPC_XY_VEL_I_ACC"],
            get["MPC_Z_VEL_I_ACC"],
            get["MPC_ACC_HOR_MAX"],
        )

    def restart(self) -> None:
        """Forget what was integrated."""
        self._integral, self._grown = ZERO3, FREE

    def velocity(self, p: Vector4, velocity: Vector3, target: Target, speeds: Speeds) -> Vector4:
        """Return a world velocity as the vehicle's reference, turning as the target says, within limits.

        Nothing is added to it: how the vehicle answers is its response model's business.
        """
        return vehicle_rates(p[3], (*speeds.limited(velocity), self._yaw_rate(p, target, speeds)))

    def accelerated(self, p: Vector4, v: Vector4, target: Target, dt: float) -> Vector3:
        """Return the target's velocities; an axis that has only an acceleration integrates it.

        Args:
            p: Where the vehicle is.
            v: Its velocities.
            target: Without position.
            dt: Time since the last call, s.
        """
        x, y, z = target.velocity
        if target.acceleration == FREE:
            self._grown = FREE
            return x or 0.0, y or 0.0, z or 0.0
        now = world_rates(p[3], v)
        grown = [
            None if speed is not None or rate is None else (start if had is None else had) + rate * dt
            for speed, rate, had, start in zip(
                target.velocity, target.acceleration, self._grown, now, strict=False
            )
        ]
        x, y, z = self.full.limited(
            (
                (x or 0.0) if grown[0] is None else grown[0],
                (y or 0.0) if grown[1] is None else grown[1],
                (z or 0.0) if grown[2] is None else grown[2],
            )
        )
        self._grown = (
            None if grown[0] is None else x,
            None if grown[1] is None else y,
            None if grown[2] is None else z,
        )
        return x, y, z

    def track(self, p: Vector4, v: Vector4, target: Target, dt: float, speeds: Speeds) -> Vector4:
        """Return the reference that brings the vehicle to the target and keeps it there, against wind too.

        Args:
            p: Where it is.
            v: Its velocities.
            target: Where it shall be.
            dt: Time since the last call, s.
            speeds: The fastest it may be.
        """
        gains = self._gains
        wanted = self._wanted(p, target, speeds)
        wx, wy, wz = wanted
        forward, left, up, omega = v
        c, s = cos(p[3]), sin(p[3])
        ex, ey, ez = wx - (c * forward - s * left), wy - (s * forward + c * left), wz - up
        ix, iy, iz = self._integral
        ax, ay, az = gains.xy_speed * ex + ix, gains.xy_speed * ey + iy, gains.z_speed * ez + iz
        if target.acceleration is not FREE:
            fx, fy, fz = target.acceleration
            ax, ay, az = ax + (fx or 0.0), ay + (fy or 0.0), az + (fz or 0.0)
        size, limit = hypot(ax, ay), gains.acceleration
        if size > limit:
            ax, ay = ax * limit / size, ay * limit / size
        if hypot(ex, ey) < _INTEGRATE_WITHIN:
            step = gains.xy_integral * dt
            ix, iy = _held(ix + step * ex), _held(iy + step * ey)
        self._integral = (ix, iy, _held(iz + gains.z_integral * dt * ez))
        yaw_rate = self._yaw_rate(p, target, speeds)
        # On turning axes the velocities change even where the world's do not: v̇ = R⁻¹ a − ω × v.
        acceleration = (
            c * ax + s * ay + omega * left,
            c * ay - s * ax - omega * forward,
            az,
            _YAW_RATE_GAIN * (yaw_rate - omega),
        )
        return self._motion.reference(v, (c * wx + s * wy, c * wy - s * wx, wz, yaw_rate), acceleration)

    def _wanted(self, p: Vector4, target: Target, speeds: Speeds) -> Vector3:
        """Return the velocity toward the target, world."""
        k, k_z = self._gains.xy, self._gains.z
        x, y, z = target.position
        vx, vy, vz = target.velocity
        return speeds.limited(
            (
                (vx or 0.0) if x is None else (vx or 0.0) + k * (x - p[0]),
                (vy or 0.0) if y is None else (vy or 0.0) + k * (y - p[1]),
                (vz or 0.0) if z is None else (vz or 0.0) + k_z * (z - p[2]),
            )
        )

    def _yaw_rate(self, p: Vector4, target: Target, speeds: Speeds) -> float:
        rate = target.yaw_rate
        if target.yaw is not None:
            rate += self._gains.yaw * wrap(target.yaw - p[3])
        return max(-speeds.turn, min(speeds.turn, rate))


def braking(speed: float, deceleration: float) -> float:
    """Return how far something goes while it brakes, v²/2a, m."""
    return speed * speed / (2.0 * deceleration) if deceleration > 0.0 else inf


def _held(integral: float) -> float:
    return max(-_INTEGRAL_LIMIT, min(_INTEGRAL_LIMIT, integral))
