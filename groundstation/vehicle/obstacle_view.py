"""What the vehicle's own distance sensors see, from MAVSDK's callbacks into one record.

Callbacks run on MAVSDK's thread and only leave what came; the link's loop makes records of it.
"""

from __future__ import annotations

import contextlib
import json
import math
from collections import deque
from collections.abc import Callable, Iterator
from typing import NamedTuple

from mavsdk import System
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkDirectError, MavlinkMessage

from groundstation.messages import Ranges, Severity
from groundstation.vehicle.distances import (
    NO_RING,
    Beam,
    DistanceError,
    Scan,
    Way,
    beam_from,
    merged,
    nearer,
    scan_from,
)
from groundstation.vehicle.telemetry import Notes

_RING, _BEAM = "OBSTACLE_DISTANCE", "DISTANCE_SENSOR"
_MESSAGE_IDS = (330, 132)
# MAV_CMD_SET_MESSAGE_INTERVAL, and 10 Hz: what PX4 gives a companion computer, but a ground station only 1 Hz of.
_SET_MESSAGE_INTERVAL, _INTERVAL_US = 511, 100_000
_AUTOPILOT = 1
# Asked so often, so far apart, s: on a poor link most questions get lost, and a vehicle without sensors needs none.
_ASKED, _ASK_S = 5, 1.0
_NO_MORE_PARAMETERS = {f"param{number}": 0.0 for number in range(3, 8)}
# A vehicle whose ring was heard no longer ago is one with a ring: records go with its rings.
_RING_S = 0.5
# A beam goes into records for so long; at 10 Hz one may be lost.
_BEAM_S = 0.25


class _Heard(NamedTuple):
    """A message as it came: when (monotonic s), what, and its fields as JSON."""

    t: float
    name: str
    fields: str


class ObstacleView:
    """The newest of every distance sensor of one vehicle.

    Args:
        system: The vehicle.
        yaw: The vehicle's newest, rad; NaN while it is not known.
        notes: Where it is said that a sensor's messages cannot be used, once for each kind.
        clock: Monotonic seconds.
    """

    def __init__(
        self, system: System, yaw: Callable[[], float], notes: Notes, clock: Callable[[], float]
    ) -> None:
        self._yaw, self._notes, self._clock = yaw, notes, clock
        self._system_id = system.get_system_id()
        self._heard: deque[_Heard] = deque(maxlen=64)
        self._beams: dict[tuple[int, int], tuple[float, Beam]] = {}
        self._ring_t = -math.inf
        self._unusable: set[str] = set()
        self._direct = MavlinkDirect(system)
        for name in (_RING, _BEAM):
            self._direct.subscribe_message(name, self._on_message)
        self._asked = 0
        self._ask_t = -math.inf

    def records(self) -> Iterator[Ranges]:
        """Yield what came since last time: a record for each ring, or for each beam where no ring comes."""
        if self._asked < _ASKED and self._clock() - self._ask_t >= _ASK_S:
            self._asked += 1
            self._ask_t = self._clock()
            for message_id in _MESSAGE_IDS:
                self._ask_for(message_id)
        while self._heard:
            heard = self._heard.popleft()
            try:
                record = self._ringed(heard) if heard.name == _RING else self._beamed(heard)
            except DistanceError as error:
                self._tell(heard.name, str(error))
                continue
            if record is not None:
                yield record

    def _ringed(self, heard: _Heard) -> Ranges:
        scan = scan_from(heard.fields, self._yaw())
        self._ring_t = heard.t
        return self._record(heard.t, scan)

    def _beamed(self, heard: _Heard) -> Ranges | None:
        beam = beam_from(heard.fields)
        if beam is None:
            return None
        self._beams[beam.source] = (heard.t, beam)
        if heard.t - self._ring_t <= _RING_S:
            return None
        return self._record(heard.t, Scan(NO_RING, math.nan))

    def _record(self, t: float, scan: Scan) -> Ranges:
        """Return a ring with all that single beams see at that time."""
        self._beams = {
            source: (heard_t, beam)
            for source, (heard_t, beam) in self._beams.items()
            if t - heard_t <= _BEAM_S
        }
        beams = [beam for _, beam in self._beams.values()]
        level = [beam for beam in beams if beam.way is Way.LEVEL]
        limits = [scan.limit, *(beam.limit for beam in level)]
        known = [limit for limit in limits if not math.isnan(limit)]
        record = Ranges(t=t, limit=max(known, default=math.nan))
        record.ring[:] = merged(scan.ring, level)
        record.below, record.above = _nearest(beams, Way.DOWN), _nearest(beams, Way.UP)
        return record

    def _ask_for(self, message_id: int) -> None:
        """Ask for a message at 10 Hz. A vehicle that denies it is looked at with the rate it gives."""
        fields: dict[str, float] = {
            "target_system": self._system_id,
            "target_component": _AUTOPILOT,
            "command": _SET_MESSAGE_INTERVAL,
            "confirmation": 0,
            "param1": message_id,
            "param2": _INTERVAL_US,
            **_NO_MORE_PARAMETERS,
        }
        command = MavlinkMessage("COMMAND_LONG", 0, 0, self._system_id, _AUTOPILOT, json.dumps(fields))
        with contextlib.suppress(MavlinkDirectError):
            self._direct.send_message(command)

    def _tell(self, name: str, why: str) -> None:
        if name not in self._unusable:
            self._unusable.add(name)
            self._notes.put((Severity.WARNING, f"The vehicle's {name} is not used: {why}."))

    def _on_message(self, message: MavlinkMessage, _: object) -> None:
        self._heard.append(_Heard(self._clock(), message.message_name, message.fields_json))


def _nearest(beams: list[Beam], way: Way) -> float:
    distance = math.nan
    for beam in beams:
        if beam.way is way:
            distance = nearer(distance, beam.distance)
    return distance
