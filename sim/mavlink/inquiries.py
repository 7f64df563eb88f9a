"""Commands that ask for messages: once, or more or less often."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite

from pymavlink.dialects.v20 import common as m

from sim.mavlink import dialect
from sim.mavlink.modes import available_modes
from sim.mavlink.request import Request
from sim.mavlink.shared import Shared
from sim.mavlink.streams import Streams

Messages = list[m.MAVLink_message]


class Inquiries:
    """Answers on one link. Each handler returns what is to be told after the acknowledgement, None to deny.

    Args:
        shared: The vehicle.
        streams: The link's telemetry.
    """

    def __init__(self, shared: Shared, streams: Streams) -> None:
        self._sim = shared.simulator
        self._streams = streams
        self.handlers: dict[int, Callable[[Request], Messages | None]] = {
            m.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_interval,
            m.MAV_CMD_GET_MESSAGE_INTERVAL: self._get_interval,
            m.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            m.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: lambda _: self._one(m.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
            m.MAV_CMD_REQUEST_PROTOCOL_VERSION: lambda _: self._one(dialect.PROTOCOL_VERSION),
            m.MAV_CMD_REQUEST_FLIGHT_INFORMATION: lambda _: self._one(m.MAVLINK_MSG_ID_FLIGHT_INFORMATION),
            m.MAV_CMD_GET_HOME_POSITION: lambda _: self._one(m.MAVLINK_MSG_ID_HOME_POSITION),
        }

    def _set_interval(self, request: Request) -> Messages | None:
        message_id, interval = request.whole(1), request.params[1]
        if message_id is None or not isfinite(interval):
            return None
        return [] if self._streams.set_interval(message_id, interval, self._sim.t) else None

    def _get_interval(self, request: Request) -> Messages | None:
        """Tell the interval of a message; 0 where there is no such one."""
        message_id = request.whole(1)
        if message_id is None or not 0 <= message_id <= 0xFFFF:
            return None
        interval = self._streams.interval_us(message_id)
        return [m.MAVLink_message_interval_message(message_id, 0 if interval is None else interval)]

    def _request_message(self, request: Request) -> Messages | None:
        message_id = request.whole(1)
        if message_id is None:
            return None
        if message_id == dialect.AVAILABLE_MODES:
            return available_modes(request.whole(2) or 0)
        if message_id == m.MAVLINK_MSG_ID_MESSAGE_INTERVAL:
            return self._get_interval(Request(request.params[1:], request.frame))
        return self._one(message_id)

    def _one(self, message_id: int) -> Messages | None:
        message = self._streams.built(message_id)
        return None if message is None else [message]
