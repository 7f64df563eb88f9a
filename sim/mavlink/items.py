"""Items of plans as they are on the wire, and the places they name."""

from __future__ import annotations

import struct
from math import isnan
from typing import NamedTuple

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.plan import Free3, Point2

_UNSET = 0x7FFFFFFF
ABSOLUTE = (m.MAV_FRAME_GLOBAL, m.MAV_FRAME_GLOBAL_INT)
RELATIVE = (m.MAV_FRAME_GLOBAL_RELATIVE_ALT, m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
_WIRE = struct.Struct("<HBBB4fddf")
# Heights beyond it are no heights, m.
_HIGHEST = 1e5


class Item(NamedTuple):
    """An item as it was uploaded.

    Attributes:
        frame: MAV_FRAME.
        command: MAV_CMD.
        current: Whether it is marked so.
        autocontinue: Likewise.
        params: Parameters 1 to 4.
        x: Latitude, degrees · 1e7 where `integer`, degrees otherwise; or parameter 5.
        y: Longitude, or parameter 6.
        z: Height, m, or parameter 7.
        integer: It came as MISSION_ITEM_INT.
    """

    frame: int
    command: int
    current: int
    autocontinue: int
    params: tuple[float, float, float, float]
    x: float
    y: float
    z: float
    integer: bool

    def place(self) -> tuple[float | None, float | None]:
        """Return latitude and longitude, degrees; None where unset."""
        if self.integer:
            latitude, longitude = (None if value == _UNSET else value * 1e-7 for value in (self.x, self.y))
            return latitude, longitude
        latitude, longitude = (None if isnan(value) else value for value in (self.x, self.y))
        return latitude, longitude

    def bits(self) -> bytes:
        """Return what tells items apart."""
        head = (self.command, self.frame, self.current, self.autocontinue)
        return _WIRE.pack(*head, *self.params, self.x, self.y, self.z)


class ItemError(Exception):
    """An item cannot be flown.

    Args:
        result: MAV_MISSION_RESULT that says so.
        why: The same in words.
    """

    def __init__(self, result: int, why: str) -> None:
        super().__init__(why)
        self.result = result


def item_from(message: m.MAVLink_mission_item_int_message | m.MAVLink_mission_item_message) -> Item:
    """Return the item of a message."""
    params = (message.param1, message.param2, message.param3, message.param4)
    integer = message.get_msgId() == m.MAVLINK_MSG_ID_MISSION_ITEM_INT
    head = (message.frame, message.command, message.current, message.autocontinue)
    return Item(*head, params, message.x, message.y, message.z, integer)


def position(item: Item) -> Free3:
    """Return the item's place, m; the height above home or above the world's zero, by its frame."""
    x, y = point(item)
    z = item.z
    if isnan(z):
        return x, y, None
    if abs(z) > _HIGHEST:
        raise ItemError(m.MAV_MISSION_INVALID_PARAM7, "a height out of range")
    return x, y, z if item.frame in RELATIVE else z - frames.ORIGIN[2]


def point(item: Item) -> tuple[float | None, float | None]:
    """Return the item's east and north, m; None for both where either is unset."""
    if item.frame not in ABSOLUTE + RELATIVE:
        raise ItemError(m.MAV_MISSION_UNSUPPORTED_FRAME, f"frame {item.frame} is not simulated")
    latitude, longitude = item.place()
    if latitude is not None and not abs(latitude) <= 90.0:
        raise ItemError(m.MAV_MISSION_INVALID_PARAM5_X, "a latitude out of range")
    if longitude is not None and not abs(longitude) <= 180.0:
        raise ItemError(m.MAV_MISSION_INVALID_PARAM6_Y, "a longitude out of range")
    if latitude is None or longitude is None:
        return None, None
    return frames.local(latitude, longitude)


def fixed(item: Item) -> Point2:
    """Return the item's east and north, m, which it must have."""
    x, y = point(item)
    if x is None or y is None:
        raise ItemError(m.MAV_MISSION_INVALID_PARAM5_X, "no place is given")
    return x, y
