"""What may leave the link besides setpoints: a list of messages, and of commands with their parameters. Pure.

What is not on it stays here, whoever made it: MAVSDK, a plugin of it, a mistake of ours. Ids and layouts are those of
MAVLink's common.xml (https://mavlink.io/en/messages/common.html); payloads are in the order of the wire.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from math import isfinite, isnan
from types import MappingProxyType
from typing import NamedTuple

HEARTBEAT, PING, PARAM_REQUEST_READ, PARAM_REQUEST_LIST, PARAM_SET = 0, 4, 20, 21, 23
COMMAND_LONG, COMMAND_ACK, TIMESYNC, AUTOPILOT_VERSION = 76, 77, 111, 148

LAND, TAKEOFF, SET_MODE, ARM, SET_MESSAGE_INTERVAL, REQUEST_MESSAGE, CAPABILITIES = (
    21, 22, 176, 400, 511, 512, 520,
)  # fmt: skip
# In the second parameter of ARM it arms or disarms whatever the vehicle thinks of it: with 0, a kill.
FORCE = 21196.0

_GROUND_STATION = 6
_REAL32 = 9
# Of a mode's flags: a custom mode; with it armed, and in the loop of a simulation.
_CUSTOM = frozenset({1.0, 33.0, 129.0, 161.0})
_HIGHEST_TAKEOFF_M = 1_000.0
# Twice what is asked of any vehicle, and slower than once in a minute, µs.
_FASTEST_US, _SLOWEST_US = 2_000.0, 60e6
_MESSAGES = 1 << 24

_HEARTBEAT = struct.Struct("<IBBBBB")
_READ = struct.Struct("<hBB16s")
_LIST = struct.Struct("<BB")
_SET = struct.Struct("<fBB16sB")
_COMMAND = struct.Struct("<7fHBBB")


class Addressee(NamedTuple):
    """Whom we fly, and what was meant a moment ago.

    Attributes:
        system: Its system id; 0 while no vehicle is known.
        modes: Custom modes, main and sub, that it may be asked for.
        killing: The operator has confirmed a kill a moment ago.
        parameters: Those that are being set, and to what.
    """

    system: int = 0
    modes: frozenset[tuple[float, float]] = frozenset()
    killing: bool = False
    parameters: Mapping[str, float] = MappingProxyType({})


Params = tuple[float, float, float, float, float, float, float]


def refusal(message: int, payload: bytes, addressee: Addressee) -> str:
    """Return what a message is that may not leave, in words, or "" where it may.

    Args:
        message: Its id.
        payload: As on the wire; MAVLink 2 cuts trailing zeros off.
        addressee: Whom we fly.
    """
    look = _LOOKS.get(message)
    if look is None:
        return "it is none that this program sends"
    return look(payload, addressee)


def _unpacked(layout: struct.Struct, payload: bytes) -> tuple[object, ...]:
    """Return a payload's fields; zeros that were cut off are put back."""
    return layout.unpack(payload[: layout.size].ljust(layout.size, b"\0"))


def _heartbeat(payload: bytes, _: Addressee) -> str:
    return "" if _unpacked(_HEARTBEAT, payload)[1] == _GROUND_STATION else "it is no ground station's"


def _harmless(_payload: bytes, _addressee: Addressee) -> str:
    return ""


def _asked_of(layout: struct.Struct, place: int) -> Callable[[bytes, Addressee], str]:
    def look(payload: bytes, addressee: Addressee) -> str:
        return _addressed(_unpacked(layout, payload)[place], addressee)

    return look


def _addressed(system: object, addressee: Addressee) -> str:
    """Say what is wrong with whom a message is for. A broadcast would move every vehicle that hears it."""
    if not addressee.system:
        return "no vehicle is known yet"
    return "" if system == addressee.system else f"it is for system {system}, not {addressee.system}"


def _parameter(payload: bytes, addressee: Addressee) -> str:
    _, system, _, name, kind = _unpacked(_SET, payload)
    assert isinstance(name, bytes)
    words = name.rstrip(b"\0").decode("ascii", errors="replace")
    if words not in addressee.parameters:
        return f"{words} is not being set"
    if not _carries(payload[:4].ljust(4, b"\0"), addressee.parameters[words], whole=kind != _REAL32):
        return f"{words} would be set to something else than was asked for"
    return _addressed(system, addressee)


def _carries(field: bytes, value: float, *, whole: bool) -> bool:
    """Say whether PARAM_SET's value is this: as a number or, with PX4, as an integer's bits.

    The two ways: https://mavlink.io/en/services/parameter.html#parameter-encoding.
    """
    as_number = isfinite(value) and field == struct.pack("<f", value)
    return as_number or (whole and value == int(value) and field == struct.pack("<i", int(value)))


def _command(payload: bytes, addressee: Addressee) -> str:
    *params, command, system, _, _ = _COMMAND.unpack(payload[: _COMMAND.size].ljust(_COMMAND.size, b"\0"))
    given: Params = tuple(params)
    if asks := _ASKS.get(command):
        return "" if asks(given) else f"command {command} with {_words(given)}"
    acts = _ACTS.get(command)
    if acts is None or not acts(given, addressee):
        return f"command {command} with {_words(given)}"
    return _addressed(system, addressee)


def _words(params: Params) -> str:
    return ", ".join("–" if _blank(each) else f"{each:g}" for each in params)


def _blank(*values: float) -> bool:
    """Say whether parameters are left to the vehicle."""
    return all(isnan(value) or value == 0.0 for value in values)


def _interval(p: Params) -> bool:
    """Allow a rate that a vehicle can give; 0 and −1 are its own and none."""
    often = p[1] in {-1.0, 0.0} or _FASTEST_US <= p[1] <= _SLOWEST_US
    return _message(p[0]) and often and _blank(*p[2:])


def _message(number: float) -> bool:
    return 0.0 <= number < _MESSAGES and number == int(number)


def _takeoff(p: Params, _: Addressee) -> bool:
    return _blank(*p[:6]) and (_blank(p[6]) or 0.0 < p[6] <= _HIGHEST_TAKEOFF_M)


def _mode(p: Params, addressee: Addressee) -> bool:
    return p[0] in _CUSTOM and (p[1], p[2]) in addressee.modes and _blank(*p[3:])


def _arm(p: Params, addressee: Addressee) -> bool:
    """Allow to arm and to disarm as the vehicle sees fit; by force only a kill that is meant."""
    forced = p[1] == FORCE and p[0] == 0.0 and addressee.killing
    return p[0] in {0.0, 1.0} and (_blank(p[1]) or forced) and _blank(*p[2:])


_ASKS: dict[int, Callable[[Params], bool]] = {
    SET_MESSAGE_INTERVAL: _interval,
    REQUEST_MESSAGE: lambda p: _message(p[0]) and _blank(*p[1:]),
    CAPABILITIES: lambda p: p[0] == 1.0 and _blank(*p[1:]),
}
_ACTS: dict[int, Callable[[Params, Addressee], bool]] = {
    LAND: lambda p, _: _blank(*p),
    TAKEOFF: _takeoff,
    SET_MODE: _mode,
    ARM: _arm,
}
_LOOKS: dict[int, Callable[[bytes, Addressee], str]] = {
    HEARTBEAT: _heartbeat,
    PING: _harmless,
    TIMESYNC: _harmless,
    # MAVSDK's own answers to who asks or commands this station.
    COMMAND_ACK: _harmless,
    AUTOPILOT_VERSION: _harmless,
    PARAM_REQUEST_READ: _asked_of(_READ, 1),
    PARAM_REQUEST_LIST: _asked_of(_LIST, 0),
    PARAM_SET: _parameter,
    COMMAND_LONG: _command,
}
