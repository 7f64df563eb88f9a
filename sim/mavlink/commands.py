"""MAV_CMD_*: each one accepted, refused with a reason, or cleanly unsupported; every one acknowledged."""

from __future__ import annotations

from math import nan

from pymavlink.dialects.v20 import common as m

from sim.mavlink.actions import Actions
from sim.mavlink.inquiries import Inquiries
from sim.mavlink.request import Request
from sim.mavlink.shared import Shared
from sim.mavlink.streams import Streams
from sim.mavlink.wire import Outbox

_UNSET = 0x7FFFFFFF
CommandMessage = m.MAVLink_command_long_message | m.MAVLink_command_int_message


class Commands:
    """Carries out commands.

    Args:
        shared: The vehicle.
        streams: The link's telemetry.
        outbox: Where acknowledgements go.
    """

    def __init__(self, shared: Shared, streams: Streams, outbox: Outbox) -> None:
        self._outbox = outbox
        self._actions = Actions(shared)
        self._inquiries = Inquiries(shared, streams)

    def long(self, message: m.MAVLink_command_long_message) -> None:
        """Carry out a COMMAND_LONG."""
        params = tuple(float(getattr(message, f"param{number}")) for number in range(1, 8))
        self._carry_out(message, Request(params, m.MAV_FRAME_GLOBAL))

    def int(self, message: m.MAVLink_command_int_message) -> None:
        """Carry out a COMMAND_INT."""
        x, y = (nan if value == _UNSET else value * 1e-7 for value in (message.x, message.y))
        params = (message.param1, message.param2, message.param3, message.param4, x, y, message.z)
        self._carry_out(message, Request(params, message.frame))

    def old_set_mode(self, message: m.MAVLink_set_mode_message) -> None:
        """Carry out SET_MODE, the message that MAV_CMD_DO_SET_MODE replaced; it has no acknowledgement."""
        main, sub = message.custom_mode >> 16 & 0xFF, message.custom_mode >> 24 & 0xFF
        self._actions.choose_mode(message.base_mode, main, sub)

    def _carry_out(self, message: CommandMessage, request: Request) -> None:
        """Acknowledge first, then tell what was asked for."""
        result, told = m.MAV_RESULT_UNSUPPORTED, []
        if action := self._actions.handlers.get(message.command):
            result = action(request)
        elif inquiry := self._inquiries.handlers.get(message.command):
            answer = inquiry(request)
            result = m.MAV_RESULT_DENIED if answer is None else m.MAV_RESULT_ACCEPTED
            told = answer or []
        to = {"target_system": message.get_srcSystem(), "target_component": message.get_srcComponent()}
        self._outbox.send(m.MAVLink_command_ack_message(message.command, result, **to))
        for each in told:
            self._outbox.send(each)
