"""Messages of MAVLink's common.xml that pymavlink's dialect of that name lacks, or has without their newest fields.

Fields are in the order of the wire. CRC extras are those of the generated headers (mavlink/c_library_v2, common).
"""

from __future__ import annotations

import struct
from typing import NamedTuple

from pymavlink.dialects.v20 import common as m

AVAILABLE_MODES, CURRENT_MODE, PROTOCOL_VERSION, REQUEST_EVENT, RESPONSE_EVENT_ERROR = 435, 436, 300, 412, 413
EVENT_UNAVAILABLE = 0


class Layout(NamedTuple):
    """A message on the wire: id, name, CRC extra, and the payload's format and fields in order."""

    id: int
    name: str
    crc_extra: int
    payload: struct.Struct
    fields: tuple[str, ...]


_MISSION_COUNT = Layout(
    m.MAVLINK_MSG_ID_MISSION_COUNT,
    "MISSION_COUNT",
    221,
    struct.Struct("<HBBBI"),
    ("count", "target_system", "target_component", "mission_type", "opaque_id"),
)
_MISSION_ACK = Layout(
    m.MAVLINK_MSG_ID_MISSION_ACK,
    "MISSION_ACK",
    153,
    struct.Struct("<BBBBI"),
    ("target_system", "target_component", "type", "mission_type", "opaque_id"),
)
_MISSION_CURRENT = Layout(
    m.MAVLINK_MSG_ID_MISSION_CURRENT,
    "MISSION_CURRENT",
    28,
    struct.Struct("<HHBBIII"),
    ("seq", "total", "mission_state", "mission_mode", "mission_id", "fence_id", "rally_points_id"),
)
_AVAILABLE_MODES = Layout(
    AVAILABLE_MODES,
    "AVAILABLE_MODES",
    134,
    struct.Struct("<IIBBB35s"),
    ("custom_mode", "properties", "number_modes", "mode_index", "standard_mode", "mode_name"),
)
_CURRENT_MODE = Layout(
    CURRENT_MODE,
    "CURRENT_MODE",
    193,
    struct.Struct("<IIB"),
    ("custom_mode", "intended_custom_mode", "standard_mode"),
)
_PROTOCOL_VERSION = Layout(
    PROTOCOL_VERSION,
    "PROTOCOL_VERSION",
    217,
    struct.Struct("<HHH8s8s"),
    ("version", "min_version", "max_version", "spec_version_hash", "library_version_hash"),
)
_RESPONSE_EVENT_ERROR = Layout(
    RESPONSE_EVENT_ERROR,
    "RESPONSE_EVENT_ERROR",
    77,
    struct.Struct("<HHBBB"),
    ("sequence", "sequence_oldest_available", "target_system", "target_component", "reason"),
)


class Extra(m.MAVLink_message):
    """A message by its layout; values are given in the order of the wire."""

    def __init__(self, layout: Layout, *values: float | bytes) -> None:
        super().__init__(layout.id, layout.name)
        self._layout = layout
        self._fieldnames = list(layout.fields)
        self._values = values

    def pack(self, mav: m.MAVLink, force_mavlink1: bool = False) -> bytes:
        """Return the frame."""
        payload = self._layout.payload.pack(*self._values)
        return self._pack(mav, self._layout.crc_extra, payload, force_mavlink1=force_mavlink1)


class RequestEvent(m.MAVLink_message):
    """REQUEST_EVENT, as pymavlink's decoder wants a class of messages."""

    id = REQUEST_EVENT
    msgname = "REQUEST_EVENT"
    fieldnames = ["target_system", "target_component", "first_sequence", "last_sequence"]  # noqa: RUF012
    ordered_fieldnames = ["first_sequence", "last_sequence", "target_system", "target_component"]  # noqa: RUF012
    fieldtypes = ["uint8_t", "uint8_t", "uint16_t", "uint16_t"]  # noqa: RUF012
    orders = [2, 3, 0, 1]  # noqa: RUF012
    lengths = [1, 1, 1, 1]  # noqa: RUF012
    array_lengths = [0, 0, 0, 0]  # noqa: RUF012
    crc_extra = 33
    unpacker = struct.Struct("<HHBB")

    def __init__(
        self, target_system: int, target_component: int, first_sequence: int, last_sequence: int
    ) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = list(self.fieldnames)
        self.target_system, self.target_component = target_system, target_component
        self.first_sequence, self.last_sequence = first_sequence, last_sequence

    def pack(self, mav: m.MAVLink, force_mavlink1: bool = False) -> bytes:
        """Return the frame."""
        payload = self.unpacker.pack(
            self.first_sequence, self.last_sequence, self.target_system, self.target_component
        )
        return self._pack(mav, self.crc_extra, payload, force_mavlink1=force_mavlink1)


m.mavlink_map.setdefault(REQUEST_EVENT, RequestEvent)

Address = tuple[int, int]


def mission_count(to: Address, count: int, kind: int, opaque_id: int) -> m.MAVLink_message:
    """How many items there are of a kind of plan, and which plan it is."""
    return Extra(_MISSION_COUNT, count, *to, kind, opaque_id)


def mission_ack(to: Address, result: int, kind: int, opaque_id: int = 0) -> m.MAVLink_message:
    """How a transfer ended, and which plan is on board after an upload."""
    return Extra(_MISSION_ACK, *to, result, kind, opaque_id)


def mission_current(
    seq: int, total: int, state: int, active: int, opaque_ids: tuple[int, int, int]
) -> m.MAVLink_message:
    """Where the mission is, and which plans are on board."""
    return Extra(_MISSION_CURRENT, seq, total, state, active, *opaque_ids)


def available_mode(  # noqa: PLR0917 (the message's fields)
    number: int, index: int, standard: int, custom: int, properties: int, name: str
) -> m.MAVLink_message:
    """One mode of `number`; `index` counts from 1."""
    return Extra(_AVAILABLE_MODES, custom, properties, number, index, standard, name.encode()[:34])


def current_mode(standard: int, custom: int, intended: int) -> m.MAVLink_message:
    """The mode in force, and the one that was asked for."""
    return Extra(_CURRENT_MODE, custom, intended, standard)


def protocol_version() -> m.MAVLink_message:
    """MAVLink 2.0, the oldest and newest as PX4 tells them."""
    return Extra(_PROTOCOL_VERSION, 200, 100, 203, bytes(8), bytes(8))


def event_error(to: Address, sequence: int) -> m.MAVLink_message:
    """There is no such event."""
    return Extra(_RESPONSE_EVENT_ERROR, sequence, 0, *to, EVENT_UNAVAILABLE)
