"""Clean refusals of what this vehicle does not have: files, logs, stored events."""

from __future__ import annotations

import struct

from pymavlink.dialects.v20 import common as m

from sim.mavlink.dialect import RequestEvent, event_error

_FTP_NAK, _FTP_UNKNOWN_COMMAND = 129, 7
_FTP_HEADER = struct.Struct("<HBBBBBBI")
_FTP_BYTES = 251


def file_refusal(message: m.MAVLink_file_transfer_protocol_message) -> m.MAVLink_message:
    """Return the answer to a file request: not acknowledged, the command is unknown here."""
    sequence, session, opcode, *_ = _FTP_HEADER.unpack(bytes(message.payload[: _FTP_HEADER.size]))
    header = _FTP_HEADER.pack((sequence + 1) & 0xFFFF, session, _FTP_NAK, 1, opcode, 0, 0, 0)
    payload = (header + bytes((_FTP_UNKNOWN_COMMAND,))).ljust(_FTP_BYTES, b"\0")
    to = (message.get_srcSystem(), message.get_srcComponent())
    return m.MAVLink_file_transfer_protocol_message(0, *to, payload)


def no_logs(_: m.MAVLink_log_request_list_message) -> m.MAVLink_message:
    """Return the answer to a question for logs: there are none."""
    return m.MAVLink_log_entry_message(0, 0, 0, 0, 0)


def no_event(message: RequestEvent) -> m.MAVLink_message:
    """Return the answer to a request for an event again: it is not kept."""
    return event_error((message.get_srcSystem(), message.get_srcComponent()), message.first_sequence)
