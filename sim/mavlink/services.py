"""The smaller MAVLink services: parameters, missions (there are none), and files (there are none)."""

from __future__ import annotations

import struct
from collections import deque

from pymavlink.dialects.v20 import common as m

from sim.autopilot.parameters import NAMES, SPECS, Parameters
from sim.mavlink.wire import Outbox

_LISTED_A_STEP = 2
_FTP_NAK, _FTP_UNKNOWN_COMMAND = 129, 7
_FTP_HEADER = struct.Struct("<HBBBBBBI")
_FTP_BYTES = 251


class ParameterService:
    """PARAM_*, bytewise: an integer's bits travel in the float's place.

    Args:
        parameters: The autopilot's.
        outbox: Where answers go.
    """

    def __init__(self, parameters: Parameters, outbox: Outbox) -> None:
        self._parameters = parameters
        self._outbox = outbox
        self._to_list: deque[int] = deque()

    def step(self) -> None:
        """Send the next few of a list that was asked for."""
        for _ in range(min(_LISTED_A_STEP, len(self._to_list))):
            self._send(self._to_list.popleft())

    def list(self, _: m.MAVLink_param_request_list_message) -> None:
        """Begin to send all, from the first."""
        self._to_list = deque(range(len(NAMES)))

    def read(self, message: m.MAVLink_param_request_read_message) -> None:
        """Answer for one, by index or name."""
        index = message.param_index
        if index == -1:
            index = _index(message.param_id)
        if 0 <= index < len(NAMES):
            self._send(index)
        else:
            self._refuse(message, index, m.MAV_PARAM_ERROR_DOES_NOT_EXIST)

    def set(self, message: m.MAVLink_param_set_message) -> None:
        """Change one, or refuse; either way the answer is the value in force."""
        index = _index(message.param_id)
        if index < 0:
            self._refuse(message, -1, m.MAV_PARAM_ERROR_DOES_NOT_EXIST)
            return
        spec = SPECS[NAMES[index]]
        kind = m.MAV_PARAM_TYPE_INT32 if spec.integer else m.MAV_PARAM_TYPE_REAL32
        value = message.param_value
        if spec.integer:
            value = float(struct.unpack("<i", struct.pack("<f", value))[0])
        if message.param_type == kind:
            self._parameters.set(NAMES[index], value)
        self._send(index)

    def _send(self, index: int) -> None:
        name = NAMES[index]
        value, kind = self._parameters[name], m.MAV_PARAM_TYPE_REAL32
        if SPECS[name].integer:
            value = struct.unpack("<f", struct.pack("<i", int(value)))[0]
            kind = m.MAV_PARAM_TYPE_INT32
        self._outbox.send(m.MAVLink_param_value_message(name.encode(), value, kind, len(NAMES), index))

    def _refuse(
        self,
        message: m.MAVLink_param_request_read_message | m.MAVLink_param_set_message,
        index: int,
        error: int,
    ) -> None:
        name = message.param_id.encode("ascii", errors="replace")[:16]
        system, component = message.get_srcSystem(), message.get_srcComponent()
        self._outbox.send(m.MAVLink_param_error_message(system, component, name, index, error))


class MissionService:
    """MISSION_*: this vehicle has no mission, fence or rally points, says so, and takes none.

    Args:
        outbox: Where answers go.
    """

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox

    def list(self, message: m.MAVLink_mission_request_list_message) -> None:
        """Say that there are none."""
        to = (message.get_srcSystem(), message.get_srcComponent())
        self._outbox.send(m.MAVLink_mission_count_message(*to, 0, message.mission_type))

    def count(self, message: m.MAVLink_mission_count_message) -> None:
        """Refuse what would be uploaded; nothing is as good as what is here."""
        self._acknowledge(message, m.MAV_MISSION_UNSUPPORTED if message.count else m.MAV_MISSION_ACCEPTED)

    def clear(self, message: m.MAVLink_mission_clear_all_message) -> None:
        """It is clear already."""
        self._acknowledge(message, m.MAV_MISSION_ACCEPTED)

    def item(
        self, message: m.MAVLink_mission_request_int_message | m.MAVLink_mission_request_message
    ) -> None:
        """There is no such item."""
        self._acknowledge(message, m.MAV_MISSION_INVALID_SEQUENCE)

    def _acknowledge(
        self,
        message: m.MAVLink_mission_count_message
        | m.MAVLink_mission_clear_all_message
        | m.MAVLink_mission_request_int_message
        | m.MAVLink_mission_request_message,
        result: int,
    ) -> None:
        to = (message.get_srcSystem(), message.get_srcComponent())
        self._outbox.send(m.MAVLink_mission_ack_message(*to, result, message.mission_type))


def file_refusal(message: m.MAVLink_file_transfer_protocol_message) -> m.MAVLink_message:
    """Return the answer to a file request: not acknowledged, the command is unknown here."""
    sequence, session, opcode, *_ = _FTP_HEADER.unpack(bytes(message.payload[: _FTP_HEADER.size]))
    header = _FTP_HEADER.pack((sequence + 1) & 0xFFFF, session, _FTP_NAK, 1, opcode, 0, 0, 0)
    payload = (header + bytes((_FTP_UNKNOWN_COMMAND,))).ljust(_FTP_BYTES, b"\0")
    to = (message.get_srcSystem(), message.get_srcComponent())
    return m.MAVLink_file_transfer_protocol_message(0, *to, payload)


def _index(name: str) -> int:
    return NAMES.index(name) if name in SPECS else -1
