"""One link of the vehicle: what is asked on it is answered on it. PX4 runs one MAVLink instance for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pymavlink.dialects.v20 import common as m

from sim.autopilot.guidance import Target
from sim.mavlink.commands import Commands
from sim.mavlink.dialect import REQUEST_EVENT
from sim.mavlink.parameters import ParameterService
from sim.mavlink.plans import PlanService
from sim.mavlink.progress import Progress
from sim.mavlink.refusals import file_refusal, no_event, no_logs
from sim.mavlink.setpoints import GlobalSetpoint, LocalSetpoint, SetpointError, global_target, local_target
from sim.mavlink.shared import Shared
from sim.mavlink.streams import Streams
from sim.mavlink.wire import AUTOPILOT_COMPONENT, Inbox, Outbox


class Link:
    """Speaks for the vehicle on one connection.

    Args:
        shared: What it has in common with the others.
        number: Its own, from 0.
        rates: Of its telemetry, Hz by message.

    Attributes:
        heard: Somebody listens. While nobody does, only heartbeats go out.
    """

    def __init__(self, shared: Shared, number: int, rates: Mapping[int, float]) -> None:
        self.heard = True
        self._shared = shared
        self._sim = shared.simulator
        self._inbox = Inbox(shared.signing)
        self._outbox = Outbox(shared.system_id, shared.signing, number)
        self._streams = Streams(shared.builders, self._outbox, rates)
        self._notices = shared.simulator.autopilot.mailbox()
        self._parameters = ParameterService(shared.simulator.autopilot.parameters, self._outbox)
        self._plans = PlanService(shared, number, self._outbox)
        self._progress = Progress(shared, self._outbox)
        commands = Commands(shared, self._streams, self._outbox)
        # Values are any: each handler is given the class that belongs to its key.
        self._handlers: dict[int, Callable[[Any], None]] = {
            m.MAVLINK_MSG_ID_HEARTBEAT: self._heartbeat,
            m.MAVLINK_MSG_ID_PING: self._ping,
            m.MAVLINK_MSG_ID_TIMESYNC: self._timesync,
            m.MAVLINK_MSG_ID_SETUP_SIGNING: self._setup_signing,
            m.MAVLINK_MSG_ID_SET_MODE: commands.old_set_mode,
            m.MAVLINK_MSG_ID_COMMAND_LONG: commands.long,
            m.MAVLINK_MSG_ID_COMMAND_INT: commands.int,
            m.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: self._parameters.list,
            m.MAVLINK_MSG_ID_PARAM_REQUEST_READ: self._parameters.read,
            m.MAVLINK_MSG_ID_PARAM_SET: self._parameters.set,
            m.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: self._plans.list,
            m.MAVLINK_MSG_ID_MISSION_REQUEST: self._plans.request,
            m.MAVLINK_MSG_ID_MISSION_REQUEST_INT: self._plans.request,
            m.MAVLINK_MSG_ID_MISSION_COUNT: self._plans.count,
            m.MAVLINK_MSG_ID_MISSION_ITEM: self._plans.item,
            m.MAVLINK_MSG_ID_MISSION_ITEM_INT: self._plans.item,
            m.MAVLINK_MSG_ID_MISSION_ACK: self._plans.acknowledged,
            m.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: self._plans.clear,
            m.MAVLINK_MSG_ID_MISSION_SET_CURRENT: self._plans.set_current,
            m.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: self._local_setpoint,
            m.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: self._global_setpoint,
            m.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: self._other_setpoint,
            m.MAVLINK_MSG_ID_MANUAL_CONTROL: shared.manual.joystick,
            m.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: shared.manual.override,
            m.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: lambda asked: self._outbox.send(file_refusal(asked)),
            m.MAVLINK_MSG_ID_LOG_REQUEST_LIST: lambda asked: self._outbox.send(no_logs(asked)),
            REQUEST_EVENT: lambda asked: self._outbox.send(no_event(asked)),
        }

    @property
    def handled(self) -> tuple[int, ...]:
        """Ids of the messages that are acted on."""
        return tuple(self._handlers)

    def receive(self, data: bytes, *, whole: bool) -> None:
        """Take bytes from ground stations, garbage included."""
        for message in self._inbox.messages(data, whole=whole):
            handler = self._handlers.get(message.get_msgId())
            if handler is not None and self._for_us(message):
                handler(message)

    def step(self) -> None:
        """Queue what is due after the simulator's step: telemetry, notices, the rest of a list."""
        self._streams.step(self._sim.t, heard=self.heard)
        self._plans.step()
        if not self.heard:
            self._notices.clear()
            return
        self._progress.step()
        self._parameters.step()
        while self._notices:
            self._outbox.say(*self._notices.popleft())

    def outgoing(self) -> list[bytes]:
        """Return the datagrams to send, and forget them."""
        return self._outbox.take()

    def _for_us(self, message: m.MAVLink_message) -> bool:
        """Say whether a message is for this vehicle's autopilot, or for everybody."""
        system = getattr(message, "target_system", getattr(message, "target", 0))
        component = getattr(message, "target_component", 0)
        return system in (0, self._shared.system_id) and component in (0, AUTOPILOT_COMPONENT)

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

    def _setup_signing(self, message: m.MAVLink_setup_signing_message) -> None:
        """Take a key, but not in flight. Who may, was checked with the frame."""
        if not self._sim.autopilot.armed:
            self._shared.signing.set_key(bytes(message.secret_key), message.initial_timestamp)

    def _local_setpoint(self, message: LocalSetpoint) -> None:
        self._steer(lambda: local_target(message, self._sim.estimate.p[3]))

    def _global_setpoint(self, message: GlobalSetpoint) -> None:
        self._steer(lambda: global_target(message, self._sim.estimate.p, self._sim.autopilot.home))

    def _steer(self, parsed: Callable[[], Target]) -> None:
        try:
            target = parsed()
        except SetpointError as error:
            self._sim.autopilot.refuse_setpoint(str(error))
        else:
            self._sim.autopilot.offboard(target)

    def _other_setpoint(self, message: m.MAVLink_message) -> None:
        self._sim.autopilot.refuse_setpoint(f"{message.get_type()} is not simulated")
