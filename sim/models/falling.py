"""A fall without rotors, and the way that velocities carry a vehicle."""

from __future__ import annotations

from math import cos, sin

from sim.kinematics import Vector3, Vector4
from sim.models.motion import GRAVITY


class Falling:
    """A vehicle whose motors have stopped in the air: gravity and linear drag −D (v − w); it keeps its yaw rate.

    Args:
        air_drag: D, 1/s.
    """

    def __init__(self, air_drag: float) -> None:
        self._drag = air_drag

    def step(self, p: Vector4, v: Vector4, wind: Vector3, dt: float) -> tuple[Vector4, Vector4]:
        """Return p and v after `dt` seconds of fall."""
        c, s, drag = cos(p[3]), sin(p[3]), self._drag
        forward = drag * (c * wind[0] + s * wind[1] - v[0]) + v[3] * v[1]
        left = drag * (c * wind[1] - s * wind[0] - v[1]) - v[3] * v[0]
        up = drag * (wind[2] - v[2]) - GRAVITY
        after = (v[0] + forward * dt, v[1] + left * dt, v[2] + up * dt, v[3])
        return carried(p, v, after, dt), after


def carried(p: Vector4, before: Vector4, after: Vector4, dt: float) -> Vector4:
    """Integrate equation (2) by the mean velocity at the mean yaw: second order in dt."""
    forward, left, up, omega = (
        0.5 * (before[0] + after[0]),
        0.5 * (before[1] + after[1]),
        0.5 * (before[2] + after[2]),
        0.5 * (before[3] + after[3]),
    )
    middle = p[3] + 0.5 * omega * dt
    c, s = cos(middle), sin(middle)
    return (
        p[0] + (c * forward - s * left) * dt,
        p[1] + (s * forward + c * left) * dt,
        p[2] + up * dt,
        p[3] + omega * dt,
    )
