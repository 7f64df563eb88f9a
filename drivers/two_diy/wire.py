"""What goes over the wire between a host and a 2DIY; as in Haply's open hAPI (Python package HaplyHAPI 1.0.1).

| direction | bytes |
|---|---|
| reset | `00 00` |
| set up | `01 05`, motors: ports, a direction each; encoders: ports, a direction each; sensors; outputs; then float32 offset (degrees) and counts a turn of each encoder |
| torques | `02 05`, float32 of each motor, N·m |
| reply to torques | `05`, float32 of each encoder, degrees |

Floats are little-endian, by number of port; motor and encoder 1 are at port 2, and 2 at port 1. There is no
checksum and no start mark that a float could not contain: what separates packets is that the device speaks only
when asked, and always 9 bytes.
"""  # noqa: E501 - a table

from __future__ import annotations

import math
import struct

DEVICE = 5
RESET = bytes((0, 0))
REPLY = struct.Struct("<Bff")
TORQUES = struct.Struct("<BBff")
SETUP = struct.Struct("<BB8B4f")

COUNTS_PER_TURN = 4880.0
HOME = (math.radians(168.0), math.radians(12.0))
"""Angles of the motors at rest, cranks spread: encoders count from there, rad."""

_SET_UP, _DRIVE = 1, 2
_BOTH_PORTS = 0b0011
_COUNTER_CLOCKWISE = 1

# Every angle that the cranks can have lies well within, rad; a shifted float rarely does.
_LARGEST_ANGLE = math.tau


def setup() -> bytes:
    """Return the packet that tells the board what is connected to its ports."""
    side = (_BOTH_PORTS, _COUNTER_CLOCKWISE, _COUNTER_CLOCKWISE)
    first, second = (math.degrees(angle) for angle in HOME)
    encoders = (second, COUNTS_PER_TURN, first, COUNTS_PER_TURN)
    return SETUP.pack(_SET_UP, DEVICE, *side, *side, 0, 0, *encoders)


def drive(torque1: float, torque2: float) -> bytes:
    """Return the packet that sets the motors' torques, N·m, and asks for the angles."""
    return TORQUES.pack(_DRIVE, DEVICE, torque2, torque1)


def angles(reply: bytes) -> tuple[float, float] | None:
    """Return the motors' angles, rad, in a reply, or None where it is not one: length, device, NaN, range."""
    if len(reply) != REPLY.size or reply[0] != DEVICE:
        return None
    _, degrees2, degrees1 = REPLY.unpack(reply)
    theta1, theta2 = math.radians(degrees1), math.radians(degrees2)
    # A comparison with NaN is false, so what is not a number does not pass.
    if abs(theta1) <= _LARGEST_ANGLE and abs(theta2) <= _LARGEST_ANGLE:
        return theta1, theta2
    return None
