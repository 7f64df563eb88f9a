"""A PX4 log (ULog) as samples: velocity setpoints and what the vehicle did, turned to our axes.

Topics and fields: PX4's uORB messages vehicle_local_position, vehicle_attitude, vehicle_angular_velocity,
vehicle_land_detected and trajectory_setpoint (vehicle_local_position_setpoint before it).
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from groundstation import frames
from groundstation.errors import InputError
from groundstation.identification.samples import Numbers, Raw, body_velocities, held

if TYPE_CHECKING:
    from pyulog import ULog

# Topics with setpoints; what is asked for comes before what PX4's position loop makes of it.
_SETPOINTS = ("trajectory_setpoint", "vehicle_local_position_setpoint")
# Names of a velocity's and a position's parts, north, east, down: since PX4 1.13, and before.
_NAMES = (
    (("velocity[0]", "velocity[1]", "velocity[2]"), ("position[0]", "position[1]", "position[2]")),
    (("vx", "vy", "vz"), ("x", "y", "z")),
)
_POSITION, _RATES, _LANDED = "vehicle_local_position", "vehicle_angular_velocity", "vehicle_land_detected"
_ATTITUDE = "vehicle_attitude"
# A setpoint is in effect until the next, but no longer than this, s: PX4's COM_OF_LOSS_T is 1 s.
_LASTS_S = 1.0

Columns = tuple[Numbers, Numbers, Numbers]
# The same turn for floats and columns, typed for floats.
_enu_from_ned = cast(Callable[[Columns], Columns], frames.enu_from_ned)


def read_ulog(path: Path) -> Raw:
    """Read a PX4 log, of a damaged one what is whole.

    Raises:
        InputError: It is none, or lacks position or setpoints.
    """
    from pyulog import ULog
    from pyulog.exceptions import ULogException

    wanted = [_POSITION, _ATTITUDE, _RATES, _LANDED, *_SETPOINTS]
    try:
        # It prints what is damaged, and our output belongs to who called.
        with path.open("rb") as file, redirect_stdout(StringIO()):
            log = ULog(file, wanted)
    except (ULogException, TypeError, ValueError, KeyError, IndexError, OSError, struct.error) as error:
        raise InputError(f"{path}: is not a PX4 log (.ulg) that can be read.") from error
    try:
        return _flight(log, path)._replace(damaged=log.file_corruption)
    except KeyError as error:
        raise InputError(
            f"{path}: a topic lacks its field {error}; the log is damaged, or of a PX4 with other names."
        ) from error


def _flight(log: ULog, path: Path) -> Raw:
    position = _topic(log, _POSITION)
    if position is None:
        raise InputError(f"{path}: has no {_POSITION}; log it, docs/identify.md tells how.")
    position = {name: column[_first_of_each(position)] for name, column in position.items()}
    t = _seconds(position)
    if len(t) < 2:
        raise InputError(f"{path}: its {_POSITION} all have the same time; the log is damaged.")
    yaw = _yaw(log, position, path)
    world = np.column_stack(_enu_from_ned((position["vx"], position["vy"], position["vz"])))
    v = body_velocities(world, yaw, _yaw_rate(log, t, yaw))
    v[~_flying(log, position)] = np.nan
    sent, ref = _references(log, t, yaw, path)
    return Raw(t, v, yaw, sent, ref)


def _topic(log: ULog, name: str) -> dict[str, Any] | None:
    for topic in log.data_list:
        if topic.name == name and topic.multi_id == 0 and len(topic.data.get("timestamp", ())):
            return topic.data
    return None


def _seconds(topic: dict[str, Any]) -> Numbers:
    return topic["timestamp"] * 1e-6


def _first_of_each(topic: dict[str, Any]) -> npt.NDArray[np.bool_]:
    """Return which rows are later than the one before."""
    return np.concatenate(([True], np.diff(topic["timestamp"].astype(np.int64)) > 0))


def _yaw(log: ULog, position: dict[str, Any], path: Path) -> Numbers:
    """Return the yaw counter-clockwise from east, not wrapped, from the heading clockwise from north."""
    if "heading" in position:
        return np.pi / 2 - np.unwrap(position["heading"].astype(np.float64))
    attitude = _topic(log, _ATTITUDE)
    if attitude is None:
        raise InputError(f"{path}: has no heading and no {_ATTITUDE}; log it, docs/identify.md tells how.")
    w, x, y, z = (attitude[f"q[{part}]"].astype(np.float64) for part in range(4))
    heading = np.unwrap(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    return np.pi / 2 - np.interp(_seconds(position), _seconds(attitude), heading)


def _yaw_rate(log: ULog, t: Numbers, yaw: Numbers) -> Numbers:
    """Return the yaw rate, counter-clockwise: the gyro's where it was logged, else the heading's slope."""
    rates = _topic(log, _RATES)
    if rates is None:
        return np.gradient(yaw, t)
    return -np.interp(t, _seconds(rates), rates["xyz[2]"])


def _flying(log: ULog, position: dict[str, Any]) -> npt.NDArray[np.bool_]:
    """Return where the vehicle is in the air and knows its velocity."""
    flying = np.ones(len(position["timestamp"]), bool)
    for name in ("v_xy_valid", "v_z_valid"):
        flying &= position.get(name, flying) != 0
    landed = _topic(log, _LANDED)
    if landed is not None:
        flying &= held(_seconds(landed), landed["landed"], _seconds(position)) != 1.0
    return flying


def _references(log: ULog, t: Numbers, yaw: Numbers, path: Path) -> tuple[Numbers, Numbers]:
    """Return when velocity setpoints were in effect, s, and what they asked for on the vehicle's axes.

    PX4 logs but every tenth or so of the setpoints, so between them they are interpolated. Those that ask for a
    position too are none of a velocity alone, and the vehicle does something else with them.
    """
    setpoint = next((found for found in (_topic(log, name) for name in _SETPOINTS) if found), None)
    if setpoint is None:
        raise InputError(
            f"{path}: has no {_SETPOINTS[0]}; log it, and fly in Offboard with velocity setpoints."
        )
    setpoint = {name: column[_first_of_each(setpoint)] for name, column in setpoint.items()}
    sent = _seconds(setpoint)
    velocity, place = _NAMES[0] if _NAMES[0][0][0] in setpoint else _NAMES[1]
    north, east, down = (setpoint[name].astype(np.float64) for name in velocity)
    world = np.column_stack((*_enu_from_ned((north, east, down)), -setpoint["yawspeed"]))
    for name in place:
        world[np.isfinite(setpoint.get(name, np.full(len(sent), np.nan)))] = np.nan
    at = np.union1d(t, sent)
    asked = np.column_stack([np.interp(at, sent, column, left=np.nan) for column in world.T])
    asked[at - held(sent, sent, at) > _LASTS_S] = np.nan
    return at, body_velocities(asked[:, :3], np.interp(at, t, yaw), asked[:, 3])
