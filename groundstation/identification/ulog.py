"""A PX4 log (ULog) as samples: velocity setpoints and what the vehicle did, turned to our axes.

Topics and fields: PX4's uORB messages vehicle_local_position, vehicle_angular_velocity, trajectory_setpoint.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from groundstation.errors import InputError
from groundstation.identification.samples import Numbers, Raw, body_velocities

if TYPE_CHECKING:
    from pyulog import ULog

_TOPICS = ("vehicle_local_position", "trajectory_setpoint")
# A setpoint is in effect until the next, but no longer than this, s: PX4's COM_OF_LOSS_T is 1 s.
_LASTS_S = 1.0


def read_ulog(path: Path) -> Raw:
    """Read a PX4 log.

    Raises:
        InputError: It is none, or lacks position or setpoints.
    """
    from pyulog import ULog
    from pyulog.exceptions import ULogException

    try:
        with path.open("rb") as file:
            log = ULog(file, [*_TOPICS, "vehicle_angular_velocity"])
    except (ULogException, TypeError, ValueError, KeyError, IndexError, OSError, struct.error) as error:
        raise InputError(f"{path}: is not a PX4 log (.ulg) that can be read.") from error
    position, setpoint = (_topic(log, name, path) for name in _TOPICS)
    t = position["timestamp"] * 1e-6
    # NED to ENU: x east, y north, z up; heading clockwise from north to yaw counter-clockwise from east.
    yaw = np.pi / 2 - position["heading"]
    velocity = np.column_stack((position["vy"], position["vx"], -position["vz"]))
    known = position.get("v_xy_valid", np.ones(len(t))) != 0
    v = body_velocities(velocity, yaw, _yaw_rate(log, t, yaw))
    v[~known] = np.nan
    order = np.concatenate(([True], np.diff(t) > 0.0))
    return Raw(t[order], v[order], _references(setpoint, t, yaw)[order])


def _topic(log: ULog, name: str, path: Path) -> dict[str, Any]:
    for topic in log.data_list:
        if topic.name == name and topic.multi_id == 0 and len(topic.data["timestamp"]):
            return topic.data
    raise InputError(
        f"{path}: has no {name}; log it (SDLOG_PROFILE) and fly in Offboard with velocity setpoints."
    )


def _yaw_rate(log: ULog, t: Numbers, yaw: Numbers) -> Numbers:
    """Return the yaw rate, counter-clockwise: the gyro's where it was logged, else the heading's slope."""
    for topic in log.data_list:
        if topic.name == "vehicle_angular_velocity" and topic.multi_id == 0:
            return -np.interp(t, topic.data["timestamp"] * 1e-6, topic.data["xyz[2]"])
    return np.gradient(np.unwrap(yaw), t)


def _references(setpoint: dict[str, Any], t: Numbers, yaw: Numbers) -> Numbers:
    """Return the velocity setpoints at given times on the vehicle's axes, NaN where none was in effect."""
    sent = setpoint["timestamp"] * 1e-6
    place = np.searchsorted(sent, t, side="right") - 1
    held = np.maximum(place, 0)
    north, east, down = (setpoint[f"velocity[{axis}]"][held] for axis in range(3))
    rate = -setpoint["yawspeed"][held]
    ref = body_velocities(np.column_stack((east, north, -down)), yaw, rate)
    ref[(place < 0) | (t - sent[held] > _LASTS_S)] = np.nan
    return ref
