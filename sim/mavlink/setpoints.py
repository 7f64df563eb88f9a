"""SET_POSITION_TARGET_LOCAL_NED into a target in our frames; what cannot be flown is refused with a reason."""

from __future__ import annotations

from math import isfinite

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.guidance import FREE, Free3, Target
from sim.kinematics import Vector3, world_rates

_POSITION = (1, 2, 4)
_VELOCITY = (8, 16, 32)
_ACCELERATION = (64, 128, 256)
_YAW, _YAW_RATE = 1024, 2048


class SetpointError(Exception):
    """A setpoint cannot be flown; the message says why."""


def target_from(message: m.MAVLink_set_position_target_local_ned_message, yaw: float) -> Target:
    """Return what a setpoint asks for.

    Frame LOCAL_NED is the world; BODY_NED is the vehicle's heading at this moment, for velocities only, as in PX4.
    An axis without position and velocity is held at no speed.

    Args:
        message: The setpoint.
        yaw: The vehicle's, rad.

    Raises:
        SetpointError: Unknown frame, nothing to follow, an acceleration, or a value used that is not finite.
    """
    mask = message.type_mask
    position = _used(mask, _POSITION, (message.x, message.y, message.z))
    velocity = _used(mask, _VELOCITY, (message.vx, message.vy, message.vz))
    if position == FREE and velocity == FREE:
        raise SetpointError("neither position nor velocity in it")
    if _used(mask, _ACCELERATION, (0.0, 0.0, 0.0)) != FREE:
        raise SetpointError("accelerations are not simulated")
    angle = None if mask & _YAW else message.yaw
    yaw_rate = 0.0 if mask & _YAW_RATE else message.yaw_rate
    if not all(isfinite(value) for value in (*position, *velocity, angle, yaw_rate) if value is not None):
        raise SetpointError("a value is not a finite number")
    vx, vy, vz = (0.0 if value is None else value for value in velocity)
    turned = None if angle is None else frames.heading(angle)
    if message.coordinate_frame == m.MAV_FRAME_LOCAL_NED:
        return Target(_enu(position), frames.enu(vx, vy, vz), turned, -yaw_rate)
    if message.coordinate_frame == m.MAV_FRAME_BODY_NED:
        if position != FREE:
            raise SetpointError("positions in BODY_NED are not simulated")
        return Target(FREE, _from_heading((vx, vy, vz), yaw), turned, -yaw_rate)
    raise SetpointError(f"frame {message.coordinate_frame} is not LOCAL_NED or BODY_NED")


def _used(mask: int, bits: tuple[int, int, int], values: Vector3) -> Free3:
    """Return the values whose ignore bit is not set, None for the others."""
    x, y, z = (None if mask & bit else value for bit, value in zip(bits, values, strict=True))
    return x, y, z


def _enu(position: Free3) -> Free3:
    north, east, down = position
    return east, north, None if down is None else -down


def _from_heading(velocity: Vector3, yaw: float) -> Vector3:
    east, north, up, _ = world_rates(yaw, (*frames.frd(*velocity), 0.0))
    return east, north, up
