"""How the mission goes on, told as it does and again for those who missed it."""

from __future__ import annotations

from pymavlink.dialects.v20 import common as m

from sim.mavlink.shared import Shared
from sim.mavlink.wire import Outbox

# MISSION_ITEM_REACHED is said so often more, so far apart, as PX4 does.
REPEATS, REPEAT_S = 10, 1.0


class Progress:
    """Tells of items under way and done, on one link.

    Args:
        shared: The vehicle.
        outbox: Where it goes.
    """

    def __init__(self, shared: Shared, outbox: Outbox) -> None:
        self._sim = shared.simulator
        self._current = shared.builders[m.MAVLINK_MSG_ID_MISSION_CURRENT]
        self._outbox = outbox
        self._index = 0
        self._count = 0
        self._left = 0
        self._told_t = 0.0

    def step(self) -> None:
        """Tell of another item under way at once, and of one that is done at once and again."""
        autopilot, t = self._sim.autopilot, self._sim.t
        if autopilot.mission_index != self._index:
            self._index = autopilot.mission_index
            if (message := self._current()) is not None:
                self._outbox.send(message)
        if autopilot.mission_reached_count != self._count:
            self._count, self._left = autopilot.mission_reached_count, 1 + REPEATS
        elif self._left == 0 or t - self._told_t < REPEAT_S:
            return
        self._left -= 1
        self._told_t = t
        if autopilot.mission_reached >= 0:
            self._outbox.send(m.MAVLink_mission_item_reached_message(autopilot.mission_reached))
