"""The round trip to the vehicle and back, by MAVLink's TIMESYNC (https://mavlink.io/en/services/timesync.html)."""

from __future__ import annotations

import json
import math
from collections.abc import Callable

from mavsdk import System
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkDirectError, MavlinkMessage

_EVERY_S = 0.5
_BELIEVABLE_S = 10.0
_SMOOTHING = 0.3


class RoundTrip:
    """Asks the vehicle for the time and measures how long the answer takes.

    Args:
        system: The vehicle.
        clock: Monotonic seconds.

    Attributes:
        seconds: Smoothed round trip, s; NaN before the first answer.
    """

    def __init__(self, system: System, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._system_id = system.get_system_id()
        self._direct = MavlinkDirect(system)
        self._next = 0.0
        self.seconds = math.nan
        self._direct.subscribe_message("TIMESYNC", self._on_answer)

    def ask(self) -> None:
        """Ask again when it is time."""
        now = self._clock()
        if now < self._next:
            return
        self._next = now + _EVERY_S
        fields = json.dumps({"tc1": 0, "ts1": int(now * 1e9)})
        try:
            self._direct.send_message(MavlinkMessage("TIMESYNC", 0, 0, self._system_id, 0, fields))
        except MavlinkDirectError:
            self.seconds = math.nan

    def _on_answer(self, message: MavlinkMessage, _: object) -> None:
        fields = json.loads(message.fields_json)
        trip = self._clock() - int(fields["ts1"]) * 1e-9
        # Somebody else's question, or our own echoed unanswered, has tc1 = 0 or a foreign clock.
        if int(fields["tc1"]) == 0 or not 0.0 < trip < _BELIEVABLE_S:
            return
        old = self.seconds
        self.seconds = trip if math.isnan(old) else old + _SMOOTHING * (trip - old)
