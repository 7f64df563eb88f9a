"""Roll and pitch, which the models of motion leave out, reconstructed from what the motors must be doing.

A multirotor accelerates by leaning its thrust. Thrust per mass is T = a + g ẑ + D (v − w) on the heading's axes,
and it points along the leaning vehicle's own up: T/|T| = (sin θ cos φ, −sin φ, cos θ cos φ), with roll φ about
forward and pitch θ about left (FLU: positive pitch is nose down). The lean follows with a time constant and stays
under a limit.
"""

from __future__ import annotations

from math import asin, atan2, cos, exp, sin, sqrt

from sim.kinematics import Vector3, Vector4
from sim.models.motion import GRAVITY

# Thrust never points down: however fast a vehicle sinks, its motors hold some of its weight.
_LEAST_THRUST = 0.3 * GRAVITY


class Lean:
    """How the vehicle leans.

    Args:
        limit: Largest roll or pitch, rad.
        time_constant: With which it follows, s.
        air_drag: D, 1/s.
    """

    def __init__(self, limit: float, time_constant: float, air_drag: float) -> None:
        self._limit = limit
        self._time_constant = time_constant
        self._drag = air_drag
        self._force: Vector3 = (0.0, 0.0, GRAVITY)
        self._blend_dt = self._blend = 0.0
        self.roll = self.pitch = 0.0
        self.roll_rate = self.pitch_rate = 0.0

    def level(self) -> None:
        """Stand on the ground."""
        self.roll = self.pitch = self.roll_rate = self.pitch_rate = 0.0
        self._force = (0.0, 0.0, GRAVITY)

    def follow(self, p: Vector4, before: Vector4, after: Vector4, wind: Vector3, dt: float) -> None:
        """Lean for a change of velocity.

        Args:
            p: Where the vehicle is, for its yaw.
            before: Velocities at the step's begin, on the vehicle's axes.
            after: At its end.
            wind: The air's velocity, world, m/s.
            dt: The step, s.
        """
        omega = after[3]
        forward = (after[0] - before[0]) / dt - omega * after[1]
        left = (after[1] - before[1]) / dt + omega * after[0]
        up = (after[2] - before[2]) / dt + GRAVITY
        self._force = (forward, left, up)
        c, s, drag = cos(p[3]), sin(p[3]), self._drag
        t_l = forward + drag * (after[0] - c * wind[0] - s * wind[1])
        t_m = left + drag * (after[1] - c * wind[1] + s * wind[0])
        t_n = max(up + drag * (after[2] - wind[2]), _LEAST_THRUST)
        roll = self._within(-asin(t_m / sqrt(t_l * t_l + t_m * t_m + t_n * t_n)))
        pitch = self._within(atan2(t_l, t_n))
        if dt != self._blend_dt:
            self._blend_dt, self._blend = dt, 1.0 - exp(-dt / self._time_constant)
        roll, pitch = self._blend * (roll - self.roll), self._blend * (pitch - self.pitch)
        self.roll_rate, self.pitch_rate = roll / dt, pitch / dt
        self.roll += roll
        self.pitch += pitch

    def specific_force(self) -> Vector3:
        """Return what an ideal accelerometer measures: a + g ẑ on the leaning vehicle's axes (FLU), m/s²."""
        return self.onto_axes(self._force)

    def onto_axes(self, vector: Vector3) -> Vector3:
        """Turn a vector on the heading's level axes onto the leaning vehicle's (both FLU)."""
        forward, left, up = vector
        c, s = cos(self.pitch), sin(self.pitch)
        forward, up = c * forward - s * up, s * forward + c * up
        c, s = cos(self.roll), sin(self.roll)
        return forward, c * left + s * up, c * up - s * left

    def _within(self, angle: float) -> float:
        return max(-self._limit, min(self._limit, angle))
