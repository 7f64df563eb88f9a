"""The Falcon's counts and axes, and ours.

The handle's frame from the device's: x = centre − z (away from the operator), y = −x, z = y.
"""

from __future__ import annotations

import math

from drivers.device import Vector3
from drivers.falcon.kinematics import Pose, torques
from drivers.falcon.packet import LARGEST_FORCE, Counts

COUNTS_PER_NM = 10_000.0
COUNT = math.radians(0.0364347)
"""Of an encoder, rad: 320 lines read four-fold, on a shaft of 14.25 mm that a drum of 110 mm turns."""

ANGLE_AT_ZERO = math.radians(35.0)


def to_handle(vector: Vector3) -> Vector3:
    """Turn a vector from the device's frame into the handle's."""
    x, y, z = vector
    return -z, -x, y


def from_handle(vector: Vector3) -> Vector3:
    """Turn a vector from the handle's frame into the device's."""
    x, y, z = vector
    return -y, z, -x


def leg_angle(count: float) -> float:
    """Return a homed leg's angle, rad, from its encoder."""
    return ANGLE_AT_ZERO + COUNT * count


def force_counts(pose: Pose, force: Vector3) -> Counts:
    """Return the motors' counts for a force on the hand, N, device's frame: −10⁴ ∂position/∂θᵀ f.

    Where a motor would exceed what it can, all three are reduced alike, so that the direction stays.
    """
    a, b, c = torques(pose, force)
    largest = max(abs(a), abs(b), abs(c)) * COUNTS_PER_NM
    scale = -COUNTS_PER_NM * (LARGEST_FORCE / largest if largest > LARGEST_FORCE else 1.0)
    return round(a * scale), round(b * scale), round(c * scale)
