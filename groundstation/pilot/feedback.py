"""What the hand feels: equation (5), f = −K p̃, and a little damping.

p̃ = p_h − p points from the drone to where the hand wants it. A drone that is blocked while the hand goes
forward leaves p̃ pointing forward, so the force pushes the hand back. A drone that is blown along +x while the
hand rests at the centre has p̃ₓ < 0 and fₓ > 0: the hand is drawn along with the drone, as the wind blows. In
both cases giving way to the force moves p_h towards the drone.
"""

from __future__ import annotations

from drivers.device import Vector3
from drivers.vectors import within
from groundstation.frames import Vector4, body_from_world


def position_force(error: Vector4, stiffness: Vector3) -> Vector3:
    """Return f = −K p̃ of equation (5), world, N.

    Args:
        error: p̃, world, m and rad; yaw has no part in equation (5).
        stiffness: k_x, k_y, k_z, N/m.
    """
    return -stiffness[0] * error[0], -stiffness[1] * error[1], -stiffness[2] * error[2]


def hand_force(
    force_world: Vector3, turn: float, velocity: Vector3, damping: float, force_limit: float
) -> Vector3:
    """Return the force to render, in the handle frame, N, no stronger than the device can.

    Args:
        force_world: From `position_force`.
        turn: Angle from the world's axes to the handle's, as in the mapping, rad.
        velocity: Of the handle, handle frame, m/s.
        damping: Against it, N·s/m.
        force_limit: Largest norm, N; a stronger force is shortened and keeps its direction.
    """
    x, y, z = body_from_world(force_world, turn)
    damped = (x - damping * velocity[0], y - damping * velocity[1], z - damping * velocity[2])
    return within(damped, force_limit)


def scaled(vector: Vector3, factor: float) -> Vector3:
    """Return a vector made longer or shorter."""
    return vector[0] * factor, vector[1] * factor, vector[2] * factor
