"""The contract of a controller, and the paper's: equations (3), (4) and (5), component by component on plain floats.

World vectors are `[x, y, z, yaw]` (ENU; m, rad), the vehicle's `[forward, left, up, yaw_rate]` (FLU; m/s,
rad/s).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, isfinite, sin, tanh
from typing import Any, NamedTuple, Protocol

from drivers.device import Vector3
from groundstation.frames import Vector4, wrap


class View(NamedTuple):
    """What a controller sees at one tick.

    Attributes:
        dt: Since the last tick, s.
        p_h: Where the hand wants the drone, world, m and rad.
        p_h_rate: ṗ_h, world, m/s and rad/s.
        p: Where the drone is seen, p(t − d₁), world, m and rad.
        velocity: As it was last told, world, m/s and rad/s.
        error: p̃ = p_h − p, the yaw wrapped.
        delay: Round trip, s.
        k1: Diagonal of K₁ in effect, 1/s.
        stiffness: k_x, k_y, k_z in effect, N/m.
        predicted: Where the drone will be as what is sent now reaches it, world, m and rad.
        predicted_velocity: Its velocity then, world, m/s.
    """

    dt: float
    p_h: Vector4
    p_h_rate: Vector4
    p: Vector4
    velocity: Vector4
    error: Vector4
    delay: float
    k1: Vector4
    stiffness: Vector3
    predicted: Vector4
    predicted_velocity: Vector3


class Law(NamedTuple):
    """What a controller answers.

    Attributes:
        v_ref: Velocity reference, vehicle's axes, m/s and rad/s.
        force: For the hand, world, N.
    """

    v_ref: Vector4
    force: Vector3


class Controller(Protocol):
    """Turns what the hand wants into a velocity for the drone and a force for the hand.

    Around any controller stand the same reference generation, guard, limits, cues and passivity. All its memory is
    its state, so that a flight in virtual time is the flight in real time.
    """

    def start(self) -> Any:  # noqa: ANN401 - the controller's own
        """Return the state at the moment of engaging."""
        ...

    def step(self, state: Any, view: View, /) -> tuple[Any, Law]:  # noqa: ANN401
        """Return the state for the next tick, and what to do in this one. Well within a millisecond."""
        ...


class PaperController:
    """Equations (4) and (5). It has no state."""

    def start(self) -> None:
        """Return nothing."""
        return

    def step(self, state: None, view: View, /) -> tuple[None, Law]:
        """Return v_ref = J⁻¹(θ) (ṗ_h + K₁ tanh(p̃)) and f = −K p̃."""
        v_ref = velocity_reference(view.p_h_rate, view.error, view.p[3], view.k1)
        return state, Law(v_ref, position_force(view.error, view.stiffness))


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


def position_force(error: Vector4, stiffness: Vector3) -> Vector3:
    """Return f = −K p̃ of equation (5), world, N.

    Args:
        error: p̃, world, m and rad; yaw has no part in equation (5).
        stiffness: k_x, k_y, k_z, N/m.
    """
    return -stiffness[0] * error[0], -stiffness[1] * error[1], -stiffness[2] * error[2]
