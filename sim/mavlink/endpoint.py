"""The vehicle's end of the MAVLink connection, in virtual time: bytes in, datagrams out, no socket and no clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pymavlink.dialects.v20 import common as m

from sim.mavlink.commands import Commands
from sim.mavlink.motion import Motion
from sim.mavlink.services import MissionService, ParameterService, file_refusal
from sim.mavlink.setpoints import SetpointError, target_from
from sim.mavlink.status import Status
from sim.mavlink.streams import Streams
from sim.mavlink.wire import AUTOPILOT_COMPONENT, Inbox, Outbox
from sim.sensors import Sensors
from sim.simulator import Simulator

SYSTEM_ID = 1


class Endpoint:
    """Speaks for a simulator as PX4 would.

    Args:
        simulator: The vehicle.
        seed: Of its sensors' noise.
        unix_time: Wall-clock time of the simulator's zero, s.
    """

    def __init__(self, simulator: Simulator, seed: int = 0, unix_time: float = 0.0) -> None:
        self._sim = simulator
        self._inbox = Inbox()
        self._outbox = Outbox(SYSTEM_ID)
        builders = Motion(simulator, Sensors(seed)).builders | Status(simulator, unix_time).builders
        self._streams = Streams(builders, self._outbox)
        self._parameters = ParameterService(simulator.autopilot.parameters, self._outbox)
        commands = Commands(simulator, self._streams, self._outbox)
        missions = MissionService(self._outbox)
        # Values are any: each handler is given the class that belongs to its key.
        self._handlers: dict[int, Callable[[Any], None]] = {
            m.MAVLINK_MSG_ID_HEARTBEAT: self._heartbeat,
            m.MAVLINK_MSG_ID_PING: self._ping,
            m.MAVLINK_MSG_ID_TIMESYNC: self._timesync,
            m.MAVLINK_MSG_ID_SET_MODE: commands.old_set_mode,
            m.MAVLINK_MSG_ID_COMMAND_LONG: commands.long,
            m.MAVLINK_MSG_ID_COMMAND_INT: commands.int,
            m.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: self._parameters.list,
            m.MAVLINK_MSG_ID_PARAM_REQUEST_READ: self._parameters.read,
            m.MAVLINK_MSG_ID_PARAM_SET: self._parameters.set,
            m.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: missions.list,
            m.MAVLINK_MSG_ID_MISSION_COUNT: missions.count,
            m.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: missions.clear,
            m.MAVLINK_MSG_ID_MISSION_REQUEST: missions.item,
            m.MAVLINK_MSG_ID_MISSION_REQUEST_INT: missions.item,
            m.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: self._setpoint,
            m.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: self._other_setpoint,
            m.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: self._other_setpoint,
            m.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: self._file_request,
        }

    def receive(self, data: bytes, *, whole: bool = True) -> None:
        """Take bytes from ground stations, garbage included.

        Args:
            data: Bytes as they came.
            whole: They are a datagram; otherwise a frame may go on in the next ones.
        """
        for message in self._inbox.messages(data, whole=whole):
            handler = self._handlers.get(message.get_msgId())
            if handler is not None and _for_us(message):
                handler(message)

    def step(self) -> None:
        """Queue what is due after the simulator's step: telemetry, notices, the rest of a list."""
        self._streams.step(self._sim.t)
        self._parameters.step()
        notices = self._sim.autopilot.notices
        while notices:
            self._outbox.say(*notices.popleft())

    def outgoing(self) -> list[bytes]:
        """Return the datagrams to send, and forget them."""
        return self._outbox.take()

    def _heartbeat(self, message: m.MAVLink_heartbeat_message) -> None:
        if message.type == m.MAV_TYPE_GCS:
            self._sim.autopilot.hear_ground_station()

    def _ping(self, message: m.MAVLink_ping_message) -> None:
        """Answer a ping that is a question: one to nobody in particular."""
        if message.target_system == 0 and message.target_component == 0:
            to = (message.get_srcSystem(), message.get_srcComponent())
            self._outbox.send(m.MAVLink_ping_message(message.time_usec, message.seq, *to))

    def _timesync(self, message: m.MAVLink_timesync_message) -> None:
        """Answer a question (tc1 = 0) with the vehicle's time, ns, and the asker's own."""
        if message.tc1 == 0:
            self._outbox.send(m.MAVLink_timesync_message(max(1, int(self._sim.t * 1e9)), message.ts1))

    def _setpoint(self, message: m.MAVLink_set_position_target_local_ned_message) -> None:
        try:
            target = target_from(message, self._sim.p[3])
        except SetpointError as error:
            self._sim.autopilot.refuse_setpoint(str(error))
        else:
            self._sim.autopilot.offboard(target)

    def _other_setpoint(self, message: m.MAVLink_message) -> None:
        self._sim.autopilot.refuse_setpoint(f"{message.get_type()} is not simulated")

    def _file_request(self, message: m.MAVLink_file_transfer_protocol_message) -> None:
        self._outbox.send(file_refusal(message))


def _for_us(message: m.MAVLink_message) -> bool:
    """Say whether a message is for this vehicle's autopilot, or for everybody."""
    system = getattr(message, "target_system", 0)
    component = getattr(message, "target_component", 0)
    return system in (0, SYSTEM_ID) and component in (0, AUTOPILOT_COMPONENT)
