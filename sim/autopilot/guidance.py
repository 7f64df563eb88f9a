"""How the autopilot steers by itself: PX4's cascade, position to velocity to acceleration, on its own model.

World ENU, vehicle FLU; metres, seconds, radians. The gains are PX4's parameters of the same names.
"""

from __future__ import annotations

from math import cos, hypot, radians, sin
from typing import NamedTuple

from sim.airframe import Airframe
from sim.autopilot.parameters import Parameters
from sim.kinematics import ZERO3, Vector3, Vector4, vehicle_rates, world_rates, wrap
from sim.models.motion import Motion

Free3 = tuple[float | None, float | None, float | None]
FREE: Free3 = (None, None, None)

# How fast a yaw rate error is turned into angular acceleration, 1/s.
_YAW_RATE_GAIN = 5.0
# The most the integrator may hold, m/s², and the velocity error beyond which it waits, m/s: what it is there for is
# steady wind, not getting up to speed or braking.
_INTEGRAL_LIMIT = 3.0
_INTEGRATE_WITHIN = 0.5


class Target(NamedTuple):
    """Where to be and how to move there, world.

    Attributes:
        position: m, by axis; None is free, then `velocity` alone steers that axis.
        velocity: m/s; with a position it is fed forward.
        yaw: rad, or None: then `yaw_rate` steers.
        yaw_rate: rad/s, counter-clockwise.
    """

    position: Free3
    velocity: Vector3 = ZERO3
    yaw: float | None = None
    yaw_rate: float = 0.0


class Guidance:
    """Turns targets into references for the vehicle.

    Args:
        motion: The model of the vehicle.
        airframe: Its limits.
        parameters: Gains and limits.
    """

    def __init__(self, motion: Motion, airframe: Airframe, parameters: Parameters) -> None:
        self._motion = motion
        self._airframe = airframe
        self._parameters = parameters
        self._integral = ZERO3

    def restart(self) -> None:
        """Forget what was integrated."""
        self._integral = ZERO3

    def velocity(self, p: Vector4, target: Target) -> Vector4:
        """Return the target's velocities as the vehicle's reference, within its limits.

        Nothing is added to them: how the vehicle answers is its response model's business.
        """
        wanted = self._limited(target.velocity, self._airframe.horizontal_speed)
        return vehicle_rates(p[3], (*wanted, self._yaw_rate(p, target)))

    def track(self, p: Vector4, v: Vector4, target: Target, dt: float, speed: float | None = None) -> Vector4:
        """Return the reference that brings the vehicle to the target and keeps it there, against wind too.

        Args:
            p: Where it is.
            v: Its velocities.
            target: Where it shall be.
            dt: Time since the last call, s.
            speed: Largest horizontal speed, m/s; MPC_XY_VEL_MAX unless given.
        """
        gains = self._parameters
        wanted = self._wanted(p, target, speed)
        now = world_rates(p[3], v)
        ex, ey, ez = wanted[0] - now[0], wanted[1] - now[1], wanted[2] - now[2]
        ix, iy, iz = self._integral
        kp, kp_z = gains["MPC_XY_VEL_P_ACC"], gains["MPC_Z_VEL_P_ACC"]
        ax, ay, az = kp * ex + ix, kp * ey + iy, kp_z * ez + iz
        size, limit = hypot(ax, ay), gains["MPC_ACC_HOR_MAX"]
        if size > limit:
            ax, ay = ax * limit / size, ay * limit / size
        if hypot(ex, ey) < _INTEGRATE_WITHIN:
            step = gains["MPC_XY_VEL_I_ACC"] * dt
            ix, iy = _held(ix + step * ex), _held(iy + step * ey)
        self._integral = (ix, iy, _held(iz + gains["MPC_Z_VEL_I_ACC"] * dt * ez))
        yaw_rate = self._yaw_rate(p, target)
        # On turning axes the velocities change even where the world's do not: v̇ = R⁻¹ a − ω × v.
        c, s, omega = cos(p[3]), sin(p[3]), v[3]
        acceleration = (
            c * ax + s * ay + omega * v[1],
            c * ay - s * ax - omega * v[0],
            az,
            _YAW_RATE_GAIN * (yaw_rate - omega),
        )
        return self._motion.reference(v, vehicle_rates(p[3], (*wanted, yaw_rate)), acceleration)

    def _wanted(self, p: Vector4, target: Target, speed: float | None) -> Vector3:
        """Return the velocity toward the target, world."""
        k, k_z = self._parameters["MPC_XY_P"], self._parameters["MPC_Z_P"]
        x, y, z = target.position
        vx, vy, vz = target.velocity
        wanted = (
            vx if x is None else vx + k * (x - p[0]),
            vy if y is None else vy + k * (y - p[1]),
            vz if z is None else vz + k_z * (z - p[2]),
        )
        limit = self._airframe.horizontal_speed
        return self._limited(wanted, limit if speed is None else min(limit, speed))

    def _limited(self, velocity: Vector3, horizontal: float) -> Vector3:
        """Cap a velocity by its horizontal norm and by axis up and down, by parameters and airframe."""
        gains, airframe = self._parameters, self._airframe
        x, y, z = velocity
        size, limit = hypot(x, y), min(horizontal, gains["MPC_XY_VEL_MAX"])
        if size > limit:
            x, y = x * limit / size, y * limit / size
        up = min(airframe.climb_speed, gains["MPC_Z_VEL_MAX_UP"])
        down = min(airframe.descent_speed, gains["MPC_Z_VEL_MAX_DN"])
        return x, y, max(-down, min(up, z))

    def _yaw_rate(self, p: Vector4, target: Target) -> float:
        limit = min(self._airframe.yaw_rate, radians(self._parameters["MPC_YAWRAUTO_MAX"]))
        rate = target.yaw_rate
        if target.yaw is not None:
            rate += self._parameters["MC_YAW_P"] * wrap(target.yaw - p[3])
        return max(-limit, min(limit, rate))


def _held(integral: float) -> float:
    return max(-_INTEGRAL_LIMIT, min(_INTEGRAL_LIMIT, integral))
