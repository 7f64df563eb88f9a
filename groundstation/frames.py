"""Every conversion between our frames and the vehicle's: ENU ↔ NED, FLU ↔ FRD, radians ↔ degrees.

Ours: world ENU, vehicle FLU, yaw counter-clockwise from east, radians. The wire's and the screen's: NED, FRD,
heading clockwise from north, degrees.
"""

from __future__ import annotations

import math

Vector3 = tuple[float, float, float]
Vector4 = tuple[float, float, float, float]


def wrap(angle: float) -> float:
    """Return the same angle within (−π, π]."""
    return math.pi - (math.pi - angle) % math.tau


def enu_from_ned(vector: Vector3) -> Vector3:
    """Turn [north, east, down] into [east, north, up]; it is its own inverse."""
    north, east, down = vector
    return east, north, -down


def frd_from_flu(velocity: Vector4) -> Vector4:
    """Turn [forward, left, up, yaw rate] into [forward, right, down, yaw rate clockwise]; its own inverse."""
    forward, left, up, yaw_rate = velocity
    return forward, -left, -up, -yaw_rate


def yaw_from_heading(heading_deg: float) -> float:
    """Turn a heading (clockwise from north, degrees) into a yaw (counter-clockwise from east, rad)."""
    return wrap(math.pi / 2 - math.radians(heading_deg))


def heading_from_yaw(yaw: float) -> float:
    """Turn a yaw (counter-clockwise from east, rad) into a heading from 0 up to 360 degrees."""
    return math.degrees(math.pi / 2 - yaw) % 360.0


def angle_from_bearing(bearing_deg: float) -> float:
    """Turn a bearing (clockwise from forward, degrees) into an angle (counter-clockwise from forward, rad)."""
    return wrap(-math.radians(bearing_deg))


def body_from_world(vector: Vector3, yaw: float) -> Vector3:
    """Turn a world vector onto the vehicle's axes: J⁻¹(θ) of equation (3) on its first three rows."""
    east, north, up = vector
    cosine, sine = math.cos(yaw), math.sin(yaw)
    return cosine * east + sine * north, cosine * north - sine * east, up
