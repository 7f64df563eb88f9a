"""The round trip to the vehicle and back, by MAVLink's TIMESYNC (https://mavlink.io/en/services/timesync.html)."""

from __future__ import annotations

import contextlib
import json
from collections import deque
from collections.abc import Callable

import msgspec
from mavsdk import System
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkDirectError, MavlinkMessage

from groundstation.vehicle.trips import Trips

EVERY_S = 0.1


class _Timesync(msgspec.Struct):
    tc1: int
    ts1: int


class RoundTrip:
    """Asks the vehicle for the time and measures how long the answer takes.

    Args:
        system: The vehicle.
        clock: Monotonic seconds.
    """

    def __init__(self, system: System, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._system_id = system.get_system_id()
        self._direct = MavlinkDirect(system)
        self._heard: deque[tuple[float, str]] = deque(maxlen=64)
        self._trips = Trips()
        self._next = 0.0
        self._direct.subscribe_message("TIMESYNC", self._on_message)

    def turn(self) -> None:
        """Take the answers that came, and ask again when it is time."""
        while self._heard:
            self._take(*self._heard.popleft())
        now = self._clock()
        if now < self._next:
            return
        self._next = now + EVERY_S
        stamp = int(now * 1e9)
        self._trips.asked(stamp, now)
        fields = json.dumps({"tc1": 0, "ts1": stamp})
        # A question that cannot be sent is lost like any other.
        with contextlib.suppress(MavlinkDirectError):
            self._direct.send_message(MavlinkMessage("TIMESYNC", 0, 0, self._system_id, 0, fields))

    @property
    def seconds(self) -> float:
        """The round trip as it is known now, s; NaN before the first answer."""
        return self._trips.seconds(self._clock())

    def _take(self, t: float, fields: str) -> None:
        try:
            told = msgspec.json.decode(fields, type=_Timesync)
        except (msgspec.DecodeError, ValueError):
            return
        # A question of the vehicle's own has tc1 = 0.
        if told.tc1 != 0:
            self._trips.answered(told.ts1, t)

    def _on_message(self, message: MavlinkMessage, _: object) -> None:
        self._heard.append((self._clock(), message.fields_json))
