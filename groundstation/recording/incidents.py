"""What went wrong, and where: alarms, warnings and collisions as a lane of states and as points in the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import zip_longest
from typing import NamedTuple

import numpy as np
import rerun as rr

from groundstation.messages import EVENT, MISSION_PROGRESS, VEHICLE_STATE, Severity
from groundstation.recording import entities, lanes
from groundstation.recording.batch import Batch, text
from groundstation.recording.item import Chunk, time_column

# How long the lane shows one, s: long enough to be seen, short enough to tell two apart.
SHOWN_S = 0.5
# Letters of an event's words that stand in the scene.
_LABEL = 60
_RANKS = (lanes.WARNING, lanes.ALARM, lanes.COLLISION)
_LEVELS: dict[int, str] = {Severity.WARNING: lanes.WARNING, Severity.ALARM: lanes.ALARM}


class Incident(NamedTuple):
    """Something that went wrong: when (s, monotonic), the lane's word for it, and what it is called."""

    t: float
    word: str
    label: str


class Incidents:
    """Collects them as records come.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
    """

    def __init__(self, start: float) -> None:
        self._start = start
        self._collisions = 0
        self._begun = False
        self._place: tuple[float, ...] | None = None

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's incidents."""
        found = list(_merged(sorted(self._found(batch))))
        changes = list(_changes(found))
        if not self._begun:
            self._begun = True
            changes.insert(0, (self._start, lanes.QUIET))
        if changes:
            times, words = zip(*changes, strict=True)
            yield Chunk(lanes.ALERT.path, self._times(*times), rr.StateChange.columns(state=list(words)))
        states = [state for state in batch.of(VEHICLE_STATE) if state.valid]
        for incident in found:
            before = [state for state in states if state.t <= incident.t]
            place = tuple(before[-1].position[:3]) if before else self._place
            if place and incident.word != lanes.WARNING:
                points = rr.Points3D.columns(positions=[place], labels=[incident.label])
                yield Chunk(entities.INCIDENTS, self._times(incident.t), points)
        if states:
            self._place = tuple(states[-1].position[:3])

    def _found(self, batch: Batch) -> Iterator[Incident]:
        for event in batch.of(EVENT):
            if word := _LEVELS.get(event.severity):
                yield Incident(event.t, word, text(event.text)[:_LABEL])
        for progress in batch.of(MISSION_PROGRESS):
            if progress.collisions > self._collisions:
                yield Incident(progress.t, lanes.COLLISION, "Collision")
            self._collisions = progress.collisions

    def _times(self, *t: float) -> rr.TimeColumn:
        return time_column(np.array(t), self._start)


def _merged(incidents: Sequence[Incident]) -> Iterator[Incident]:
    """Make one of those that follow each other at once: the worst, in the words of the first that is no warning."""
    together: list[Incident] = []
    for incident, after in zip_longest(incidents, incidents[1:]):
        together.append(incident)
        if after is None or after.t > incident.t + SHOWN_S:
            worst = max(together, key=lambda each: _RANKS.index(each.word))
            graver = [each for each in together if each.word != lanes.WARNING] or together
            yield Incident(together[0].t, worst.word, graver[0].label)
            together.clear()


def _changes(incidents: Sequence[Incident]) -> Iterator[tuple[float, str]]:
    """Yield the lane's changes: each incident, and the quiet after it."""
    for incident in incidents:
        yield incident.t, incident.word
        yield incident.t + SHOWN_S, lanes.QUIET
