"""A fall without rotors: `v̇ = −D (v − w) − g ẑ` in the world, solved exactly; the vehicle keeps its yaw rate."""

from __future__ import annotations

from math import cos, expm1, sin

from sim.kinematics import Vector3, Vector4
from sim.models.motion import GRAVITY

# Below this share D·dt a step the solution's series is closer than its cancelling differences.
_SERIES = 1e-3
# dt; what of a velocity is left after it; what a unit of velocity, and one of acceleration, moves in it: s, s².
Decay = tuple[float, float, float, float]


class Falling:
    """A vehicle whose motors have stopped in the air.

    Args:
        air_drag: D, 1/s.
    """

    def __init__(self, air_drag: float) -> None:
        self._drag = air_drag
        self._decay = decay(air_drag, 0.0)

    def step(self, p: Vector4, v: Vector4, wind: Vector3, dt: float) -> tuple[Vector4, Vector4]:
        """Return p and v after `dt` seconds of fall."""
        if dt != self._decay[0]:
            self._decay = decay(self._drag, dt)
        return fall(p, v, wind, self._drag, self._decay)


def decay(drag: float, dt: float) -> Decay:
    """Return the constants of `fall` for steps of `dt` seconds in a drag of `drag` 1/s."""
    share = drag * dt
    if share < _SERIES:
        moved = dt * (1.0 - share / 2.0 * (1.0 - share / 3.0 * (1.0 - share / 4.0)))
        return dt, 1.0 - drag * moved, moved, dt * dt * (0.5 - share / 6.0 * (1.0 - share / 4.0))
    moved = -expm1(-share) / drag
    return dt, 1.0 - drag * moved, moved, (dt - moved) / drag


def fall(p: Vector4, v: Vector4, wind: Vector3, drag: float, decay: Decay) -> tuple[Vector4, Vector4]:
    """Return p and v one step later.

    Args:
        p: `[x, y, z, yaw]`, world.
        v: `[forward, left, up, yaw_rate]`.
        wind: The air's velocity, world, m/s.
        drag: D, 1/s.
        decay: See `decay`.
    """
    dt, left_over, moved, pushed = decay
    c, s = cos(p[3]), sin(p[3])
    vx, vy, vz = c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]
    ax, ay, az = drag * wind[0], drag * wind[1], drag * wind[2] - GRAVITY
    yaw = p[3] + v[3] * dt
    p = (
        p[0] + moved * vx + pushed * ax,
        p[1] + moved * vy + pushed * ay,
        p[2] + moved * vz + pushed * az,
        yaw,
    )
    c, s = cos(yaw), sin(yaw)
    vx, vy, vz = left_over * vx + moved * ax, left_over * vy + moved * ay, left_over * vz + moved * az
    return p, (c * vx + s * vy, c * vy - s * vx, vz, v[3])
