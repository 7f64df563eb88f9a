"""What came over the bus since the last batch, and the taps it comes from. Imports nothing heavy."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Any, TypeVar, cast

from groundstation.bus import Bus, Subscriber
from groundstation.messages import (
    ATTITUDE,
    COMMAND,
    COMMAND_ANSWER,
    DEVICE_REPORT,
    EVENT,
    HANDLE,
    HEARTBEAT,
    INTERVENTION,
    INTERVENTION_ANSWER,
    MISSION_PROGRESS,
    OBSTACLES,
    PARAMETER,
    PILOT_STATE,
    POINTS_LOST,
    SERVO_REPORT,
    SETPOINT,
    TICK_INPUTS,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Record,
    Topic,
)

R = TypeVar("R", bound=Record)

TOPICS: tuple[Topic[Any], ...] = (
    HANDLE,
    TICK_INPUTS,
    SETPOINT,
    PILOT_STATE,
    VEHICLE_STATE,
    ATTITUDE,
    VEHICLE_STATUS,
    OBSTACLES,
    PARAMETER,
    COMMAND,
    COMMAND_ANSWER,
    INTERVENTION,
    INTERVENTION_ANSWER,
    EVENT,
    SERVO_REPORT,
    DEVICE_REPORT,
    MISSION_PROGRESS,
    POINTS_LOST,
    HEARTBEAT,
)


def text(field: bytes) -> str:
    """Return a record's text field; bytes that are no UTF-8 are replaced."""
    return field.decode(errors="replace")


class Batch:
    """Records of one stretch of time, in the order they came, topic by topic.

    Attributes:
        arrays: The same by topic's name, as `groundstation.recording.columns.rows_in` makes them, once for all.
    """

    def __init__(self) -> None:
        self.arrays: dict[str, Any] = {}
        self._records: dict[str, list[Record]] = {topic.name: [] for topic in TOPICS}

    def of(self, topic: Topic[R]) -> list[R]:
        """Return the records of a topic."""
        return cast(list[R], self._records[topic.name])

    def add(self, topic: Topic[R], records: Iterable[R]) -> int:
        """Take records in and return how many they were."""
        kept = self._records[topic.name]
        before = len(kept)
        kept.extend(records)
        return len(kept) - before

    def parts(self, longest: float) -> Iterator[Batch]:
        """Yield it in parts of at most so long, s, in their order; what is no longer is yielded as it is.

        What a large batch takes on its way into the file, Rerun keeps for itself.
        """
        ends = [record.t for kept in self._records.values() for record in (*kept[:1], *kept[-1:])]
        if not ends or max(ends) - min(ends) <= longest:
            yield self
            return
        first, parts = min(ends), defaultdict[int, Batch](Batch)
        for topic in TOPICS:
            for record in self.of(topic):
                parts[int((record.t - first) / longest)].add(topic, (record,))
        yield from (parts[number] for number in sorted(parts))


class Taps:
    """Subscribers to every topic, there from the first moment so that nothing is lost."""

    def __init__(self, bus: Bus) -> None:
        self._taps: list[tuple[Topic[Any], Subscriber[Any]]] = [
            (topic, bus.subscriber(topic)) for topic in TOPICS
        ]
        self._batch = Batch()

    def drain(self) -> bool:
        """Take in what has come; say whether the handle's tap, which fills first, may have overrun."""
        taken = {topic.name: self._batch.add(topic, tap.drain()) for topic, tap in self._taps}
        return taken[HANDLE.name] >= HANDLE.depth

    def take(self) -> Batch:
        """Return what has been drained since last time."""
        batch, self._batch = self._batch, Batch()
        return batch
