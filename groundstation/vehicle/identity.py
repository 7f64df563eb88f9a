"""Which firmware the vehicle runs, from AUTOPILOT_VERSION: asked for until it is told.

Callbacks run on MAVSDK's thread and only leave what came. Source: MAVLink common.xml, AUTOPILOT_VERSION, and
FIRMWARE_VERSION_TYPE for the lowest byte of a version.
"""

from __future__ import annotations

import contextlib
import json
from collections import deque
from collections.abc import Callable

import msgspec
from mavsdk import System
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkDirectError, MavlinkMessage

_NAME, _MESSAGE = "AUTOPILOT_VERSION", 148
_REQUEST_MESSAGE = 512
# Asked so often, so far apart, s: MAVSDK asks by itself as well.
_ASKED, _ASK_S = 10, 1.0
_STAGES = ((64, "dev"), (128, "alpha"), (192, "beta"), (255, "rc"))
_RELEASE = 255


class _Version(msgspec.Struct):
    flight_sw_version: int


def firmware(version: int) -> str:
    """Return a version as people write it, as in 1.15.2 or 1.16.0 (beta), or "" where none is told."""
    if not version:
        return ""
    numbers = ".".join(str(version >> shift & 0xFF) for shift in (24, 16, 8))
    kind = version & 0xFF
    stage = "" if kind == _RELEASE else next(word for below, word in _STAGES if kind < below)
    return f"{numbers} ({stage})" if stage else numbers


class Identity:
    """Who the vehicle is.

    Args:
        system: The vehicle.
        clock: Monotonic seconds.

    Attributes:
        firmware: Its version, or "" while it has not been told.
        component: Of the autopilot in MAVLink; 0 likewise.
    """

    def __init__(self, system: System, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._system_id = system.get_system_id()
        self._direct = MavlinkDirect(system)
        self._heard: deque[MavlinkMessage] = deque(maxlen=4)
        self._left, self._next = _ASKED, 0.0
        self.firmware = ""
        self.component = 0
        self._direct.subscribe_message(_NAME, self._on_message)

    def turn(self) -> None:
        """Take what came, and ask again when it is time."""
        while self._heard:
            self._take(self._heard.popleft())
        now = self._clock()
        if self.firmware or not self._left or now < self._next:
            return
        self._left, self._next = self._left - 1, now + _ASK_S
        params = {f"param{number}": 0.0 for number in range(2, 8)}
        fields = json.dumps(
            {
                "target_system": self._system_id,
                "target_component": 1,
                "command": _REQUEST_MESSAGE,
                "confirmation": 0,
                "param1": float(_MESSAGE),
                **params,
            }
        )
        # A question that cannot be sent is lost like any other.
        with contextlib.suppress(MavlinkDirectError):
            self._direct.send_message(MavlinkMessage("COMMAND_LONG", 0, 0, self._system_id, 1, fields))

    def _on_message(self, message: MavlinkMessage, _: object) -> None:
        self._heard.append(message)

    def _take(self, message: MavlinkMessage) -> None:
        try:
            told = msgspec.json.decode(message.fields_json, type=_Version)
        except (msgspec.DecodeError, ValueError):
            return
        self.component = message.component_id
        self.firmware = firmware(told.flight_sw_version & 0xFFFFFFFF)
