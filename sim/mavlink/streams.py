"""Which messages go out when: PX4's default rates, and the intervals a ground station asks for."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import common as m

from sim.mavlink.dialect import CURRENT_MODE
from sim.mavlink.motion import Builder
from sim.mavlink.wire import Outbox

# Physics runs at 250 Hz; nothing new can be told more often.
SHORTEST_S = 0.004
# MESSAGE_INTERVAL can tell no longer one.
LONGEST_S = 2147.0
_STAGGER_S = 0.004

# Hz. PX4's MAVLINK_MODE_ONBOARD (mavlink_main.cpp), the heartbeat as its sender has it; GPS at its receiver's rate.
ONBOARD_RATES: dict[int, float] = {
    m.MAVLINK_MSG_ID_HEARTBEAT: 1.0,
    m.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 30.0,
    m.MAVLINK_MSG_ID_ATTITUDE: 100.0,
    m.MAVLINK_MSG_ID_HIGHRES_IMU: 50.0,
    m.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 50.0,
    m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 50.0,
    m.MAVLINK_MSG_ID_ODOMETRY: 30.0,
    m.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 5.0,
    m.MAVLINK_MSG_ID_SYS_STATUS: 5.0,
    m.MAVLINK_MSG_ID_BATTERY_STATUS: 0.5,
    m.MAVLINK_MSG_ID_HOME_POSITION: 0.5,
    m.MAVLINK_MSG_ID_GPS_RAW_INT: 5.0,
    m.MAVLINK_MSG_ID_ALTITUDE: 10.0,
    m.MAVLINK_MSG_ID_VFR_HUD: 10.0,
    m.MAVLINK_MSG_ID_DISTANCE_SENSOR: 10.0,
    m.MAVLINK_MSG_ID_WIND_COV: 10.0,
    m.MAVLINK_MSG_ID_RC_CHANNELS: 20.0,
    m.MAVLINK_MSG_ID_SCALED_PRESSURE: 1.0,
    m.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    m.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 1.0,
    m.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: 10.0,
    m.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: 10.0,
    m.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: 10.0,
    m.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: 10.0,
    m.MAVLINK_MSG_ID_VIBRATION: 0.5,
    m.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: 1.0,
    m.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
    m.MAVLINK_MSG_ID_TIMESYNC: 10.0,
    m.MAVLINK_MSG_ID_PING: 1.0,
    CURRENT_MODE: 0.5,
}

# Hz. PX4's MAVLINK_MODE_NORMAL, with the seven faster streams its simulation asks for (px4-rc.mavlink).
GROUND_STATION_RATES: dict[int, float] = {
    m.MAVLINK_MSG_ID_HEARTBEAT: 1.0,
    m.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 50.0,
    m.MAVLINK_MSG_ID_ATTITUDE: 50.0,
    m.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 50.0,
    m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 50.0,
    m.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 1.0,
    m.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
    m.MAVLINK_MSG_ID_BATTERY_STATUS: 0.5,
    m.MAVLINK_MSG_ID_HOME_POSITION: 0.5,
    m.MAVLINK_MSG_ID_GPS_RAW_INT: 5.0,
    m.MAVLINK_MSG_ID_ALTITUDE: 1.0,
    m.MAVLINK_MSG_ID_VFR_HUD: 4.0,
    m.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.5,
    m.MAVLINK_MSG_ID_WIND_COV: 0.5,
    m.MAVLINK_MSG_ID_RC_CHANNELS: 20.0,
    m.MAVLINK_MSG_ID_SCALED_PRESSURE: 1.0,
    m.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 0.5,
    m.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: 1.0,
    m.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: 50.0,
    m.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: 1.0,
    m.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: 1.0,
    m.MAVLINK_MSG_ID_VIBRATION: 0.1,
    m.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: 1.0,
    m.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
    m.MAVLINK_MSG_ID_PING: 0.1,
    CURRENT_MODE: 0.5,
}


class Streams:
    """Sends each message when it is due.

    Args:
        builders: How to build each message there is.
        outbox: Where it goes.
        rates: By default, Hz by message.
    """

    def __init__(self, builders: Mapping[int, Builder], outbox: Outbox, rates: Mapping[int, float]) -> None:
        self._builders = builders
        self._outbox = outbox
        self._rates = rates
        self._interval: dict[int, float] = {}
        self._due: dict[int, float] = {}
        for place, (message_id, rate) in enumerate(rates.items()):
            self._interval[message_id] = 1.0 / rate
            self._due[message_id] = place * _STAGGER_S

    def set_interval(self, message_id: int, interval_us: float, t: float) -> bool:
        """Change how often a message goes out, as MAV_CMD_SET_MESSAGE_INTERVAL says it: 0 default, negative never.

        Returns:
            Whether there is such a message, and its rate may be changed (the heartbeat's may not).
        """
        if message_id not in self._builders or message_id == m.MAVLINK_MSG_ID_HEARTBEAT:
            return False
        if interval_us == 0 and message_id in self._rates:
            self._interval[message_id] = 1.0 / self._rates[message_id]
        elif interval_us > 0:
            self._interval[message_id] = max(SHORTEST_S, min(LONGEST_S, interval_us * 1e-6))
        else:
            self._interval.pop(message_id, None)
            self._due.pop(message_id, None)
            return True
        self._due[message_id] = t
        return True

    def interval_us(self, message_id: int) -> int | None:
        """Return the interval in force, −1 for never, or None where there is no such message."""
        if message_id not in self._builders:
            return None
        interval = self._interval.get(message_id)
        return -1 if interval is None else round(interval * 1e6)

    def built(self, message_id: int) -> m.MAVLink_message | None:
        """Return a message as it would go out now; None where there is no such one, or nothing to tell."""
        builder = self._builders.get(message_id)
        return None if builder is None else builder()

    def step(self, t: float, *, heard: bool = True) -> None:
        """Send what is due at time `t`, s. A stream that fell behind skips what it missed.

        Args:
            t: Now, s.
            heard: Somebody listens; otherwise only the heartbeat goes out.
        """
        # Half a step of grace: a due time that rounding puts just after this step belongs to it.
        now = t + 0.5 * SHORTEST_S
        for message_id, due in self._due.items():
            if now < due:
                continue
            if heard or message_id == m.MAVLINK_MSG_ID_HEARTBEAT:
                message = self._builders[message_id]()
                if message is not None:
                    self._outbox.send(message)
            interval = self._interval[message_id]
            self._due[message_id] = due + interval * ((now - due) // interval + 1.0)
