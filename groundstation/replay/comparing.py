"""What a servo says now, beside what the recording says that it said: bit for bit, quantity by quantity."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import zip_longest
from typing import Any, NamedTuple

import numpy as np

from groundstation.messages import COMMAND_ANSWER, EVENT, HANDLE, PILOT_STATE, SETPOINT, CommandKind, Topic
from groundstation.pilot.chooser import CHOOSING
from groundstation.recording import entities, lanes, schema
from groundstation.recording.batch import Batch, text
from groundstation.recording.changes import Changes
from groundstation.recording.columns import number_columns
from groundstation.recording.item import Chunk
from groundstation.recording.schema import Quantity
from groundstation.review.flight import Flight, Numbers, Series

_OF_PILOT: tuple[Topic[Any], ...] = (HANDLE, SETPOINT, PILOT_STATE, COMMAND_ANSWER)
_ANSWERED = [int(kind) for kind in (*CHOOSING, CommandKind.ENGAGE, CommandKind.DISENGAGE)]
_LANES = (lanes.PHASE, lanes.MAPPING, lanes.PRESET, lanes.GUARD, lanes.COMPENSATION)
_WORDS = (entities.REASON, entities.GUARDED)
_EVENTS = f"{entities.EVENTS}/pilot"
# The pilot's decisions. What else it tells are words of a device's driver and of the system, which no replay asks.
_DECIDED = ("Engag", "Disengag")
# A recorder that begins to listen a little after the pilot lacks the first rows, s.
_LATE_S = 2.0
# Times of words are recorded in whole milliseconds, those of events a moment after the tick began, s.
_MOMENT_S = 0.005


class Difference(NamedTuple):
    """Where what was recorded and what is said now part.

    Attributes:
        t: When first, monotonic s.
        what: The quantity's entity, and its part.
        recorded, now: What was and what is said then.
    """

    t: float
    what: str
    recorded: str
    now: str


class Timed(NamedTuple):
    """Words, and when they were said, monotonic s."""

    t: float
    words: str


class Said:
    """What a servo says, as it would be recorded, gathered batch by batch.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
    """

    def __init__(self, start: float) -> None:
        self._start, self._changes = start, Changes(start)
        self._columns: dict[Quantity, list[Series]] = {}
        self._words: dict[str, list[Timed]] = {}

    def add(self, batch: Batch) -> None:
        """Take in what was said."""
        own = Batch()
        for topic in _OF_PILOT:
            own.add(topic, batch.of(topic))
        for quantity, t, values in number_columns(own):
            self._columns.setdefault(quantity, []).append(Series(t, values.reshape(len(t), -1)))
        for chunk in self._changes.chunks(own):
            self._words.setdefault(chunk.path, []).extend(_words_in(chunk, self._start))
        events = (Timed(event.t, text(event.text)) for event in batch.of(EVENT))
        self._words.setdefault(_EVENTS, []).extend(events)

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """All that anything was said of."""
        return tuple(self._columns)

    def series(self, quantity: Quantity) -> Series:
        """Return the rows of a quantity; times monotonic, s."""
        parts = self._columns[quantity]
        return Series(
            np.concatenate([part.t for part in parts]), np.concatenate([part.values for part in parts])
        )

    def words(self, path: str) -> list[Timed]:
        """Return the words of an entity."""
        return self._words.get(path, [])


def differences(flight: Flight, said: Said, ticks: Numbers) -> list[Difference]:
    """Return where a recording and what is said now differ first, a row a quantity, the first first.

    Args:
        flight: The recording.
        said: All that was said.
        ticks: (n,), of the servo, monotonic s.
    """
    first, last = float(ticks[0]), float(ticks[-1])
    found = [
        _words(lane.path, [Timed(t + flight.start, word) for t, word in flight.states(lane)], said, last)
        for lane in _LANES
    ]
    for path in (_EVENTS, *_WORDS):
        lines = [Timed(line.t + flight.start, line.text) for line in flight.texts(path)]
        found.append(_words(path, lines, said, last))
    version = int(flight.properties().get("schema", 1))
    for quantity in said.quantities:
        if schema.SINCE.get(quantity, 1) > version:
            continue
        recorded, now = _recorded(flight, quantity, last), said.series(quantity)
        if len(recorded.t):
            late = int(np.searchsorted(now.t, min(recorded.t[0], first + _LATE_S)))
            now = Series(now.t[late:], now.values[late:])
        found.append(_numbers(quantity, recorded, now))
    return sorted((each for each in found if each), key=lambda each: each.t)


def _recorded(flight: Flight, quantity: Quantity, until: float) -> Series:
    """Return the recorded rows of a quantity up to a time; times monotonic, s."""
    t, values = flight.clock(quantity), flight.series(quantity).values
    kept = t <= until
    if quantity is schema.ANSWERED:
        kept &= np.isin(values[:, 1], _ANSWERED)
    return Series(t[kept], values[kept])


def _numbers(quantity: Quantity, recorded: Series, now: Series) -> Difference | None:
    n = min(len(recorded.t), len(now.t))
    same_time = recorded.t[:n] == now.t[:n]
    same = _same(recorded.values[:n], now.values[:n])
    rows = np.flatnonzero(~(same_time & same.all(axis=1)))
    place = int(rows[0]) if len(rows) else n
    if place < n and same_time[place]:
        part = int(np.argmin(same[place]))
        was, is_ = (repr(float(series.values[place, part])) for series in (recorded, now))
        return Difference(float(now.t[place]), f"{quantity.path} {quantity.parts[part]}", was, is_)
    t_was, t_is = (float(series.t[place]) if place < len(series.t) else np.inf for series in (recorded, now))
    if t_was == t_is:
        return None
    words = ("a row", "none") if t_was < t_is else ("none", "a row")
    return Difference(min(t_was, t_is), quantity.path, *words)


def _same(before: Numbers, after: Numbers) -> np.ndarray:
    """Say where numbers are the same to the last bit; one that is not known is like another."""
    bits = np.ascontiguousarray(before).view(np.int64) == np.ascontiguousarray(after).view(np.int64)
    return bits | (np.isnan(before) & np.isnan(after))


def _words(path: str, recorded: Iterable[Timed], said: Said, until: float) -> Difference | None:
    always = path != _EVENTS
    before, after = (
        [
            line
            for line in lines
            if line.t <= until + _MOMENT_S and (always or line.words.startswith(_DECIDED))
        ]
        for lines in (recorded, said.words(path))
    )
    for was, is_ in zip_longest(before, after):
        if was is None or is_ is None or was.words != is_.words or abs(was.t - is_.t) > _MOMENT_S:
            return Difference(
                _first(was, is_), path, *(line.words if line else "nothing" for line in (was, is_))
            )
    return None


def _first(*lines: Timed | None) -> float:
    return min(line.t for line in lines if line)


def _words_in(chunk: Chunk, start: float) -> Sequence[Timed]:
    """Return the words of a chunk as a recording gives them back."""
    times = chunk.times.times.cast("int64").to_numpy() * 1e-9 + start
    cells = next(iter(chunk.columns)).as_arrow_array().to_pylist()
    return [Timed(t, words) for t, (words,) in zip(times.tolist(), cells, strict=True)]
