"""What the vehicle tells of where it is going: the target it steers to, and how far its mission has come."""

from __future__ import annotations

from math import atan2, degrees, hypot, nan

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.modes import Mode
from sim.autopilot.plan import Free3
from sim.kinematics import Vector3
from sim.mavlink.dialect import mission_current
from sim.mavlink.motion import Builder, boot_ms, int16, int32
from sim.mavlink.plan_store import PlanStore
from sim.simulator import Simulator

_POSITION, _VELOCITY, _ACCELERATION = (1, 2, 4), (8, 16, 32), (64, 128, 256)
_YAW, _YAW_RATE = 1024, 2048
# MISSION_CURRENT's mission_mode.
_IN_MISSION, _NOT_IN_MISSION = 1, 2
_FARTHEST_TOLD = 0xFFFF


class Targets:
    """Builds the messages on targets and mission.

    Args:
        simulator: The vehicle.
        plans: On board.
    """

    def __init__(self, simulator: Simulator, plans: PlanStore) -> None:
        self._sim = simulator
        self._plans = plans
        self.builders: dict[int, Builder] = {
            m.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: self.position_target_local_ned,
            m.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: self.position_target_global_int,
            m.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: self.nav_controller_output,
            m.MAVLINK_MSG_ID_MISSION_CURRENT: self.mission_current,
        }

    def position_target_local_ned(self) -> m.MAVLink_message | None:
        """What is steered to; a free axis is NaN and masked out."""
        if not self._sim.autopilot.armed:
            return None
        target = self._sim.autopilot.target
        mask, position, rates = _ned_fields(target.position, target.velocity, target.acceleration)
        yaw, yaw_mask = (nan, _YAW) if target.yaw is None else (frames.heading(target.yaw), _YAW_RATE)
        return m.MAVLink_position_target_local_ned_message(
            boot_ms(self._sim),
            m.MAV_FRAME_LOCAL_NED,
            mask | yaw_mask,
            *position,
            *rates,
            yaw,
            -target.yaw_rate,
        )

    def position_target_global_int(self) -> m.MAVLink_message | None:
        """The same on the globe; told where there is a place to tell."""
        if not self._sim.autopilot.armed or (place := self._place()) is None:
            return None
        target = self._sim.autopilot.target
        mask, _, rates = _ned_fields(target.position, target.velocity, target.acceleration)
        latitude, longitude, height = frames.geodetic(*place)
        yaw, yaw_mask = (nan, _YAW) if target.yaw is None else (frames.heading(target.yaw), _YAW_RATE)
        return m.MAVLink_position_target_global_int_message(
            boot_ms(self._sim),
            m.MAV_FRAME_GLOBAL_INT,
            mask | yaw_mask,
            int32(latitude * 1e7),
            int32(longitude * 1e7),
            height,
            *rates,
            yaw,
            -target.yaw_rate,
        )

    def nav_controller_output(self) -> m.MAVLink_message | None:
        """How far it is to the target, and in which direction."""
        if not self._sim.autopilot.armed or (place := self._place()) is None:
            return None
        x, y, z, _ = self._sim.estimate.p
        east, north = place[0] - x, place[1] - y
        attitude = self._sim.attitude
        bearing = int16(degrees(atan2(east, north)))
        return m.MAVLink_nav_controller_output_message(
            degrees(attitude.roll),
            degrees(-attitude.pitch),
            bearing,
            bearing,
            min(round(hypot(east, north)), _FARTHEST_TOLD),
            place[2] - z,
            0.0,
            0.0,
        )

    def mission_current(self) -> m.MAVLink_message:
        """Where the mission is, and which plans are on board."""
        autopilot = self._sim.autopilot
        total = len(self._plans[m.MAV_MISSION_TYPE_MISSION].items)
        flying = autopilot.mode is Mode.MISSION
        if total == 0:
            state = m.MISSION_STATE_NO_MISSION
        elif autopilot.mission_finished:
            state = m.MISSION_STATE_COMPLETE
        elif flying:
            state = m.MISSION_STATE_ACTIVE
        else:
            state = m.MISSION_STATE_PAUSED if autopilot.mission_index > 0 else m.MISSION_STATE_NOT_STARTED
        mode = _IN_MISSION if flying else _NOT_IN_MISSION
        return mission_current(autopilot.mission_index, total, state, mode, self._plans.opaque_ids())

    def _place(self) -> Vector3 | None:
        """Return the target's position; where one axis of it is free there is none."""
        x, y, z = self._sim.autopilot.target.position
        return None if x is None or y is None or z is None else (x, y, z)


def _ned_fields(
    position: Free3, velocity: Free3, acceleration: Free3
) -> tuple[int, Vector3, tuple[float, float, float, float, float, float]]:
    """Return the type mask, position, and velocity with acceleration, in NED; NaN where free."""
    mask, fields = 0, list[float]()
    vectors = (position, velocity, acceleration)
    for bits, (east, north, up) in zip((_POSITION, _VELOCITY, _ACCELERATION), vectors, strict=True):
        down = None if up is None else -up
        for bit, value in zip(bits, (north, east, down), strict=True):
            mask |= bit if value is None else 0
            fields.append(nan if value is None else value)
    x, y, z, vx, vy, vz, ax, ay, az = fields
    return mask, (x, y, z), (vx, vy, vz, ax, ay, az)
