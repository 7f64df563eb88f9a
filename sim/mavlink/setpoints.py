"""Offboard setpoints of the wire into targets in our frames; what cannot be flown is refused with a reason.

Frames and masks as PX4 has them (mavlink_receiver.cpp). Two differences, both toward caution: a value that is used
must be a finite number, where PX4 takes NaN for "free"; and it must be within the bounds below.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.guidance import FREE, Free3, Target
from sim.kinematics import Vector3, Vector4, world_rates

_POSITION = (1, 2, 4)
_VELOCITY = (8, 16, 32)
_ACCELERATION = (64, 128, 256)
_FORCE, _YAW, _YAW_RATE = 512, 1024, 2048
_ABSOLUTE = (m.MAV_FRAME_GLOBAL, m.MAV_FRAME_GLOBAL_INT)
_RELATIVE = (m.MAV_FRAME_GLOBAL_RELATIVE_ALT, m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
# Farther, faster or harder than any vehicle here goes: m, then m/s, m/s² and rad/s.
_FAR, _FAST = 1e6, 1e4
LocalSetpoint = m.MAVLink_set_position_target_local_ned_message
GlobalSetpoint = m.MAVLink_set_position_target_global_int_message


class SetpointError(Exception):
    """A setpoint cannot be flown; the message says why."""


def local_target(message: LocalSetpoint, yaw: float) -> Target:
    """Return what a setpoint in NED or on the heading asks for.

    Frame LOCAL_NED is the world; BODY_NED is the vehicle's heading at this moment, for velocities and accelerations
    only, as in PX4.

    Args:
        message: The setpoint.
        yaw: The vehicle's, rad.

    Raises:
        SetpointError: Unknown frame, nothing to follow, or a value used that is not finite or out of range.
    """
    position = _used(message.type_mask, _POSITION, (message.x, message.y, message.z))
    if message.coordinate_frame == m.MAV_FRAME_LOCAL_NED:
        return _target(message, _enu(position), _enu)
    if message.coordinate_frame == m.MAV_FRAME_BODY_NED:
        if position != FREE:
            raise SetpointError("positions in BODY_NED are not simulated")
        return _target(message, FREE, lambda vector: _from_heading(vector, yaw))
    raise SetpointError(f"frame {message.coordinate_frame} is not LOCAL_NED or BODY_NED")


def global_target(message: GlobalSetpoint, p: Vector4, home: Vector4) -> Target:
    """Return what a setpoint on the globe asks for.

    Args:
        message: The setpoint.
        p: Where the vehicle is; an axis of the level that is not given stays there.
        home: What relative heights count from.

    Raises:
        SetpointError: As above.
    """
    frame = message.coordinate_frame
    if frame not in _ABSOLUTE + _RELATIVE:
        raise SetpointError(f"frame {frame} is not GLOBAL_INT or GLOBAL_RELATIVE_ALT_INT")
    north, east, height = _used(
        message.type_mask, _POSITION, (message.lat_int * 1e-7, message.lon_int * 1e-7, message.alt)
    )
    x, y, z = None, None, None
    if north is not None or east is not None:
        here_north, here_east, _ = frames.geodetic(*p[:3])
        latitude, longitude = here_north if north is None else north, here_east if east is None else east
        if abs(latitude) > 90.0 or abs(longitude) > 180.0:
            raise SetpointError("latitude or longitude is out of range")
        x, y = frames.local(latitude, longitude)
    if height is not None:
        z = height + (home[2] if frame in _RELATIVE else -frames.ORIGIN[2])
    return _target(message, (x, y, z), _enu)


def _target(
    message: LocalSetpoint | GlobalSetpoint, position: Free3, turned: Callable[[Free3], Free3]
) -> Target:
    """Put a target together; `turned` brings velocities and accelerations into the world."""
    mask = message.type_mask
    velocity = _used(mask, _VELOCITY, (message.vx, message.vy, message.vz))
    acceleration = _used(mask, _ACCELERATION, (message.afx, message.afy, message.afz))
    if mask & _FORCE and acceleration != FREE:
        raise SetpointError("forces are not simulated")
    if position == velocity == acceleration == FREE:
        raise SetpointError("neither position, velocity nor acceleration in it")
    yaw = None if mask & _YAW else message.yaw
    yaw_rate = 0.0 if mask & _YAW_RATE else message.yaw_rate
    _check(position, _FAR)
    _check((*velocity, *acceleration, yaw, yaw_rate), _FAST)
    heading = None if yaw is None else frames.heading(yaw)
    return Target(position, turned(velocity), heading, -yaw_rate, turned(acceleration))


def _check(values: tuple[float | None, ...], limit: float) -> None:
    for value in values:
        if value is not None and not isfinite(value):
            raise SetpointError("a value is not a finite number")
        if value is not None and abs(value) > limit:
            raise SetpointError("a value is out of range")


def _used(mask: int, bits: tuple[int, int, int], values: Vector3) -> Free3:
    """Return the values whose ignore bit is not set, None for the others."""
    x, y, z = (None if mask & bit else value for bit, value in zip(bits, values, strict=True))
    return x, y, z


def _enu(vector: Free3) -> Free3:
    north, east, down = vector
    return east, north, None if down is None else -down


def _from_heading(vector: Free3, yaw: float) -> Free3:
    """Turn a vector on the heading, FRD, into the world; forward and right belong together, one unused is 0."""
    forward, right, down = vector
    up = None if down is None else -down
    if forward is None and right is None:
        return None, None, up
    east, north, _, _ = world_rates(yaw, (forward or 0.0, -(right or 0.0), 0.0, 0.0))
    return east, north, up
