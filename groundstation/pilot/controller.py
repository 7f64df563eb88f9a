"""The paper's kinematics and control law: equations (3) and (4), component by component on plain floats.

World vectors are `[x, y, z, yaw]` (ENU; m, rad), the vehicle's `[forward, left, up, yaw_rate]` (FLU; m/s,
rad/s).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, isfinite, sin, tanh

from groundstation.frames import Vector4, wrap


def check_gains(name: str, gains: Sequence[float]) -> None:
    """Check the diagonal of a gain matrix, which the paper wants positive.

    Raises:
        ValueError: With the gain's name and the reason.
    """
    for place, gain in enumerate(gains):
        if not (isfinite(gain) and gain > 0.0):
            raise ValueError(f"{name}[{place}] is {gain}; a gain must be a positive, finite number.")


def world_rates(v: Vector4, theta: float) -> Vector4:
    """Turn the vehicle's velocities into the world: ṗ = J(θ) v, equations (2) and (3).

    Args:
        v: Vehicle's velocities, m/s and rad/s.
        theta: Yaw of the vehicle, rad.
    """
    v_l, v_m, v_n, v_theta = v
    c, s = cos(theta), sin(theta)
    return c * v_l - s * v_m, s * v_l + c * v_m, v_n, v_theta


def vehicle_rates(p_rate: Vector4, theta: float) -> Vector4:
    """Turn rates in the world onto the vehicle's axes: v = J⁻¹(θ) ṗ; J is a rotation, so J⁻¹(θ) = J(−θ)."""
    return world_rates(p_rate, -theta)


def position_error(p_h: Vector4, p: Vector4) -> Vector4:
    """Return p̃ = p_h(t) − p(t − d₁), the yaw by the shorter way round; world, m and rad."""
    return p_h[0] - p[0], p_h[1] - p[1], p_h[2] - p[2], wrap(p_h[3] - p[3])


def velocity_reference(p_h_rate: Vector4, error: Vector4, theta: float, k1: Vector4) -> Vector4:
    """Return v_ref = J⁻¹(θ) (ṗ_h + K₁ tanh(p̃)), equation (4).

    Args:
        p_h_rate: ṗ_h, world, m/s and rad/s.
        error: p̃, world, m and rad.
        theta: Yaw of the vehicle, rad.
        k1: Diagonal of K₁: the speed with which a large error is closed, m/s and rad/s.

    Returns:
        v_ref on the vehicle's axes, m/s and rad/s.
    """
    return vehicle_rates(
        (
            p_h_rate[0] + k1[0] * tanh(error[0]),
            p_h_rate[1] + k1[1] * tanh(error[1]),
            p_h_rate[2] + k1[2] * tanh(error[2]),
            p_h_rate[3] + k1[3] * tanh(error[3]),
        ),
        theta,
    )
