"""Parameters as the vehicle tells them, whoever asked or changed them: PARAM_VALUE goes to all who listen.

Callbacks run on MAVSDK's thread and only leave what came. Source: https://mavlink.io/en/services/parameter.html,
"Parameter encoding".
"""

from __future__ import annotations

import math
import struct
from collections import deque
from collections.abc import Iterator

import msgspec
from mavsdk import System
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkMessage

_AUTOPILOT = 1
_REAL32 = 9
# More than any autopilot has, for all may be listed at once.
_MOST = 4096


class _Told(msgspec.Struct):
    param_id: str
    param_value: float | None
    param_type: int


def decoded(fields: str, *, bytewise: bool) -> tuple[str, float] | None:
    """Return a parameter's name and value from PARAM_VALUE as MAVSDK gives it, or None where it is none.

    Args:
        fields: The message in JSON.
        bytewise: A whole number's bits travel in the float's place; else the float has its value.
    """
    try:
        told = msgspec.json.decode(fields, type=_Told)
        # The bits of some whole numbers are no float's, and JSON has null for them: nothing that is judged is so.
        value = math.nan if told.param_value is None else told.param_value
        if bytewise and told.param_type != _REAL32:
            value = (
                float(struct.unpack("<i", struct.pack("<f", value))[0]) if math.isfinite(value) else math.nan
            )
    except (msgspec.DecodeError, ValueError, OverflowError):
        return None
    return told.param_id, value


class Overheard:
    """What the vehicle told of its parameters, in the order it did.

    Args:
        system: The vehicle.
        bytewise: How it has whole numbers on the wire; see `decoded`.
    """

    def __init__(self, system: System, *, bytewise: bool) -> None:
        self._source = system.get_system_id(), _AUTOPILOT
        self._bytewise = bytewise
        self._heard: deque[MavlinkMessage] = deque(maxlen=_MOST)
        self._direct = MavlinkDirect(system)
        self._direct.subscribe_message("PARAM_VALUE", self._on_message)

    def take(self) -> Iterator[tuple[str, float]]:
        """Yield name and value of each that came since this was last emptied."""
        while self._heard:
            told = decoded(self._heard.popleft().fields_json, bytewise=self._bytewise)
            if told is not None:
                yield told

    def _on_message(self, message: MavlinkMessage, _: object) -> None:
        if (message.system_id, message.component_id) == self._source:
            self._heard.append(message)
