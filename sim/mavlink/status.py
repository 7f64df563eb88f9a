"""What the vehicle tells of its state: mode, health, battery, home, version; one builder a message."""

from __future__ import annotations

from math import nan

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.modes import Mode
from sim.mavlink import dialect
from sim.mavlink.manual import UNUSED, Manual
from sim.mavlink.modes import CUSTOM_MODES, base_mode, custom_mode
from sim.mavlink.motion import Builder, boot_ms, boot_us, int32
from sim.simulator import Simulator

CAPABILITIES = (
    m.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | m.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | m.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | m.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    | m.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | m.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | m.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    | m.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
    | m.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | m.MAV_PROTOCOL_CAPABILITY_MAVLINK2
)
# The release whose behaviour is simulated: 1.15.0, official.
_FIRMWARE = 1 << 24 | 15 << 16 | 0 << 8 | 255
_SENSORS = (
    m.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | m.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | m.MAV_SYS_STATUS_SENSOR_3D_MAG
    | m.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
    | m.MAV_SYS_STATUS_SENSOR_GPS
    | m.MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL
    | m.MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION
    | m.MAV_SYS_STATUS_SENSOR_YAW_POSITION
    | m.MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL
    | m.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
    | m.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
    | m.MAV_SYS_STATUS_AHRS
    | m.MAV_SYS_STATUS_SENSOR_BATTERY
)
_ESTIMATES = (
    m.ESTIMATOR_ATTITUDE
    | m.ESTIMATOR_VELOCITY_HORIZ
    | m.ESTIMATOR_VELOCITY_VERT
    | m.ESTIMATOR_POS_HORIZ_REL
    | m.ESTIMATOR_POS_HORIZ_ABS
    | m.ESTIMATOR_POS_VERT_ABS
)
_NEEDS_POSITION = m.ESTIMATOR_POS_HORIZ_REL | m.ESTIMATOR_POS_HORIZ_ABS | m.ESTIMATOR_VELOCITY_HORIZ
_LATITUDE, _LONGITUDE, _HEIGHT = frames.ORIGIN


class Status:
    """Builds the messages on everything but motion.

    Args:
        simulator: The vehicle.
        manual: Its sticks.
        system_id: Its own; part of its unique id.
        unix_time: Wall-clock time of the simulator's zero, s.
    """

    def __init__(self, simulator: Simulator, manual: Manual, system_id: int, unix_time: float) -> None:
        self._sim = simulator
        self._manual = manual
        self._system_id = system_id
        self._unix_time = unix_time
        self._pings = 0
        self.builders: dict[int, Builder] = {
            m.MAVLINK_MSG_ID_HEARTBEAT: self.heartbeat,
            m.MAVLINK_MSG_ID_SYS_STATUS: self.sys_status,
            m.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: self.extended_sys_state,
            m.MAVLINK_MSG_ID_SYSTEM_TIME: self.system_time,
            m.MAVLINK_MSG_ID_BATTERY_STATUS: self.battery_status,
            m.MAVLINK_MSG_ID_HOME_POSITION: self.home_position,
            m.MAVLINK_MSG_ID_WIND_COV: self.wind_cov,
            m.MAVLINK_MSG_ID_AUTOPILOT_VERSION: self.autopilot_version,
            m.MAVLINK_MSG_ID_ESTIMATOR_STATUS: self.estimator_status,
            m.MAVLINK_MSG_ID_FLIGHT_INFORMATION: self.flight_information,
            m.MAVLINK_MSG_ID_RC_CHANNELS: self.rc_channels,
            m.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: self.gps_global_origin,
            m.MAVLINK_MSG_ID_TIMESYNC: self.timesync,
            m.MAVLINK_MSG_ID_PING: self.ping,
            dialect.CURRENT_MODE: self.current_mode,
            dialect.PROTOCOL_VERSION: dialect.protocol_version,
        }

    def heartbeat(self) -> m.MAVLink_message:
        """Mode, armed, and how bad it is."""
        autopilot = self._sim.autopilot
        flags = base_mode(autopilot.mode)
        if autopilot.armed:
            flags |= m.MAV_MODE_FLAG_SAFETY_ARMED
        if autopilot.terminated:
            state = m.MAV_STATE_FLIGHT_TERMINATION
        elif autopilot.failsafe:
            state = m.MAV_STATE_CRITICAL
        else:
            state = m.MAV_STATE_ACTIVE if autopilot.armed else m.MAV_STATE_STANDBY
        mode = custom_mode(autopilot.mode)
        return m.MAVLink_heartbeat_message(m.MAV_TYPE_QUADROTOR, m.MAV_AUTOPILOT_PX4, flags, mode, state, 3)

    def sys_status(self) -> m.MAVLink_message:
        """Health bits, battery."""
        autopilot, battery = self._sim.autopilot, self._sim.battery
        present = _SENSORS | m.MAV_SYS_STATUS_PREARM_CHECK
        if autopilot.plan.fence:
            present |= m.MAV_SYS_STATUS_GEOFENCE
        health = _SENSORS
        if not autopilot.fence_breach:
            health |= m.MAV_SYS_STATUS_GEOFENCE
        if self._manual.channels:
            present |= m.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
            health |= m.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
        if "gps" in self._sim.failed:
            health &= ~m.MAV_SYS_STATUS_SENSOR_GPS
        if not self._sim.estimate.valid_position:
            health &= ~m.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
        if battery.remaining <= autopilot.parameters["BAT_CRIT_THR"]:
            health &= ~m.MAV_SYS_STATUS_SENSOR_BATTERY
        if autopilot.armed or not autopilot.arming_obstacle():
            health |= m.MAV_SYS_STATUS_PREARM_CHECK
        millivolts = round(1e3 * battery.cell_voltage * battery.cells)
        percent = round(100 * battery.remaining)
        return m.MAVLink_sys_status_message(
            present, present, health, 0, min(millivolts, 0xFFFF), -1, percent, 0, 0, 0, 0, 0, 0
        )

    def extended_sys_state(self) -> m.MAVLink_message:
        """On the ground, or in the air and doing what."""
        autopilot = self._sim.autopilot
        if autopilot.landed:
            state = m.MAV_LANDED_STATE_ON_GROUND
        elif autopilot.mode is Mode.TAKEOFF:
            state = m.MAV_LANDED_STATE_TAKEOFF
        elif autopilot.mode is Mode.LAND:
            state = m.MAV_LANDED_STATE_LANDING
        else:
            state = m.MAV_LANDED_STATE_IN_AIR
        return m.MAVLink_extended_sys_state_message(m.MAV_VTOL_STATE_UNDEFINED, state)

    def system_time(self) -> m.MAVLink_message:
        """Wall-clock time."""
        return m.MAVLink_system_time_message(int((self._unix_time + self._sim.t) * 1e6), boot_ms(self._sim))

    def battery_status(self) -> m.MAVLink_message:
        """The battery, cell by cell as far as the message has room."""
        battery = self._sim.battery
        cell = round(1e3 * battery.cell_voltage)
        cells = [cell] * min(battery.cells, 10)
        return m.MAVLink_battery_status_message(
            0,
            m.MAV_BATTERY_FUNCTION_ALL,
            m.MAV_BATTERY_TYPE_LIPO,
            32767,
            [*cells, *[0xFFFF] * (10 - len(cells))],
            -1,
            -1,
            -1,
            round(100 * battery.remaining),
        )

    def home_position(self) -> m.MAVLink_message:
        """Where the vehicle was armed."""
        x, y, z, yaw = self._sim.autopilot.home
        latitude, longitude, height = frames.geodetic(x, y, z)
        turn = frames.quaternion(0.0, 0.0, frames.heading(yaw))
        return m.MAVLink_home_position_message(
            int32(latitude * 1e7),
            int32(longitude * 1e7),
            int32(height * 1e3),
            *frames.ned(x, y, z),
            turn,
            nan,
            nan,
            nan,
            boot_us(self._sim),
        )

    def wind_cov(self) -> m.MAVLink_message:
        """The wind: where the air goes to, NED."""
        height = frames.ORIGIN[2] + self._sim.p[2]
        north, east, down = frames.ned(*self._sim.wind)
        return m.MAVLink_wind_cov_message(boot_us(self._sim), north, east, down, 0, 0, height, 0, 0)

    def autopilot_version(self) -> m.MAVLink_message:
        """What this is and can."""
        nothing = (0,) * 8
        return m.MAVLink_autopilot_version_message(
            CAPABILITIES, _FIRMWARE, _FIRMWARE, 0, 0, nothing, nothing, nothing, 0, 0, self._system_id
        )

    def estimator_status(self) -> m.MAVLink_message:
        """What the estimator trusts."""
        valid = self._sim.estimate.valid_position
        flags = _ESTIMATES if valid else _ESTIMATES & ~_NEEDS_POSITION
        accuracy = 0.5 if valid else 50.0
        return m.MAVLink_estimator_status_message(
            boot_us(self._sim), flags, 0, 0, 0, 0, 0, 0, accuracy, accuracy
        )

    def flight_information(self) -> m.MAVLink_message:
        """When this flight began."""
        autopilot = self._sim.autopilot
        armed = autopilot.armed_t if autopilot.armed else None
        took_off = autopilot.took_off_t if autopilot.armed else None
        return m.MAVLink_flight_information_message(
            boot_ms(self._sim), self._unix_us(armed), self._unix_us(took_off), 0
        )

    def rc_channels(self) -> m.MAVLink_message:
        """The channels as they were overridden; there is no other radio."""
        channels = self._manual.channels
        number = sum(us != UNUSED for us in channels)
        told = channels or (UNUSED,) * 18
        return m.MAVLink_rc_channels_message(boot_ms(self._sim), number, *told, rssi=255)

    def gps_global_origin(self) -> m.MAVLink_message:
        """Where the local frame has its origin."""
        return m.MAVLink_gps_global_origin_message(
            round(_LATITUDE * 1e7), round(_LONGITUDE * 1e7), round(_HEIGHT * 1e3), boot_us(self._sim)
        )

    def current_mode(self) -> m.MAVLink_message:
        """The mode in force, and the one that was asked for."""
        autopilot = self._sim.autopilot
        named = CUSTOM_MODES[autopilot.mode]
        return dialect.current_mode(named.standard, named.custom, CUSTOM_MODES[autopilot.wanted].custom)

    def timesync(self) -> m.MAVLink_message:
        """A question for the other side's time."""
        return m.MAVLink_timesync_message(0, int(self._sim.t * 1e9))

    def ping(self) -> m.MAVLink_message:
        """A question whether anybody is there."""
        self._pings += 1
        return m.MAVLink_ping_message(boot_us(self._sim), self._pings - 1 & 0xFFFFFFFF, 0, 0)

    def _unix_us(self, t: float | None) -> int:
        return 0 if t is None else int((self._unix_time + t) * 1e6)
