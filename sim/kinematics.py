"""The kinematic model of a multirotor: equations (1) to (3) of the paper, on plain floats.

World ENU, vehicle FLU with yaw only, θ counter-clockwise from east; metres, radians, seconds. The configuration is
`p = [p_x, p_y, p_z, p_θ]` (equation 1), the manoeuvrability velocities are `v = [v_l, v_m, v_n, v_θ]`: forward,
left, up, yaw rate.
"""

from __future__ import annotations

from math import cos, pi, sin, tau

Vector3 = tuple[float, float, float]
Vector4 = tuple[float, float, float, float]

ZERO3: Vector3 = (0.0, 0.0, 0.0)
ZERO4: Vector4 = (0.0, 0.0, 0.0, 0.0)


def world_rates(theta: float, v: Vector4) -> Vector4:
    """Return ṗ = J(θ) v, equations (2) and (3).

    Args:
        theta: Yaw, rad.
        v: `[forward, left, up, yaw_rate]`, m/s and rad/s.

    Returns:
        `[ṗ_x, ṗ_y, ṗ_z, ṗ_θ]`, m/s and rad/s.
    """
    c, s = cos(theta), sin(theta)
    return c * v[0] - s * v[1], s * v[0] + c * v[1], v[2], v[3]


def vehicle_rates(theta: float, p_dot: Vector4) -> Vector4:
    """Return v = J⁻¹(θ) ṗ. J is a rotation, so its inverse is its transpose."""
    c, s = cos(theta), sin(theta)
    return c * p_dot[0] + s * p_dot[1], c * p_dot[1] - s * p_dot[0], p_dot[2], p_dot[3]


def advance(p: Vector4, v: Vector4, dt: float) -> Vector4:
    """Return p + J(θ) v dt: equation (2) integrated over one step, yaw not wrapped."""
    x, y, z, theta = world_rates(p[3], v)
    return p[0] + x * dt, p[1] + y * dt, p[2] + z * dt, p[3] + theta * dt


def wrap(angle: float) -> float:
    """Return the same angle within (−π, π]."""
    return pi - (pi - angle) % tau
