"""The plans on board as they were uploaded, and their names; what they mean goes to the autopilot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from zlib import crc32

from pymavlink.dialects.v20 import common as m

from sim.autopilot.autopilot import Autopilot
from sim.mavlink.items import Item, ItemError
from sim.mavlink.legs import legs
from sim.mavlink.zones import rally_points, zones

# As many of each kind as PX4 holds.
MOST_ITEMS = {m.MAV_MISSION_TYPE_MISSION: 2000, m.MAV_MISSION_TYPE_FENCE: 64, m.MAV_MISSION_TYPE_RALLY: 32}


class Stored(NamedTuple):
    """One kind of plan: its items, and a number that tells it from another."""

    items: tuple[Item, ...] = ()
    opaque_id: int = 0


class PlanStore:
    """Mission, fence and rally points of one vehicle, for all its links.

    Args:
        autopilot: Flies by them.

    Attributes:
        uploading: The link that is uploading one, by number.
    """

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._stored = dict.fromkeys(MOST_ITEMS, Stored())
        self.uploading: int | None = None

    def __getitem__(self, kind: int) -> Stored:
        return self._stored.get(kind, Stored())

    def opaque_ids(self) -> tuple[int, int, int]:
        """Return the plans' numbers: mission, fence, rally points; 0 where there is none."""
        mission, fence, rally = (stored.opaque_id for stored in self._stored.values())
        return mission, fence, rally

    def load(self, kind: int, items: Sequence[Item]) -> None:
        """Take a plan in the place of the last, or leave the last where it is.

        Raises:
            ItemError: It cannot be flown.
        """
        autopilot = self._autopilot
        if kind == m.MAV_MISSION_TYPE_MISSION:
            verdict = autopilot.load_mission(legs(items))
        elif kind == m.MAV_MISSION_TYPE_FENCE:
            verdict = autopilot.load_fence(zones(items))
        else:
            verdict = autopilot.load_rally(rally_points(items, autopilot.home[2]))
        if not verdict.ok:
            raise ItemError(m.MAV_MISSION_DENIED, verdict.why)
        self._stored[kind] = Stored(tuple(items), _name(items))


def _name(items: Sequence[Item]) -> int:
    """Return a number for a plan, 0 for an empty one only."""
    return (crc32(b"".join(item.bits() for item in items)) or 1) if items else 0
