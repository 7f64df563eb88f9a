"""What of a recording is exported: the quantities, states and events that are asked for, in the time asked for."""

from __future__ import annotations

import datetime
import json
import math
from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from typing import Any, NamedTuple

import numpy as np

from groundstation.errors import InputError
from groundstation.recording import entities, schema
from groundstation.recording.lanes import LANES
from groundstation.recording.schema import Quantity
from groundstation.review.flight import Flight, Line, Numbers

# Words that are logged when they change, as states are, but may be any.
_WORDS = {
    entities.REASON: "Why the hand is not coupled",
    entities.GUARDED: "What the guard keeps away from",
    entities.INTERVENTIONS: "What was let happen, as it was asked for and answered",
}


class Asked(NamedTuple):
    """What is asked for.

    Attributes:
        globs: Patterns of entities' paths; none: all.
        start, end: s since the run was started.
    """

    globs: tuple[str, ...] = ()
    start: float = -math.inf
    end: float = math.inf


class Table(NamedTuple):
    """A quantity's rows: (n,) times, s, and (n, k) values, a column a part."""

    quantity: Quantity
    t: Numbers
    values: Numbers


class Changes(NamedTuple):
    """A state's path and meaning, and its changes: when, s, and to what."""

    path: str
    meaning: str
    changes: Sequence[tuple[float, str]]


class Selection:
    """What is to be exported of a flight.

    Args:
        flight: The recording.
        asked: What of it.

    Attributes:
        started_ns: Wall-clock time at 0 of the timeline, ns since 1970.
        properties: Of the flight; `device` those of the device.
        tables, states, events: What there is, in the order of the schema.

    Raises:
        InputError: Nothing is left, or the recording does not say when it was made.
    """

    def __init__(self, flight: Flight, asked: Asked) -> None:
        self.flight = flight
        self.properties = flight.properties()
        self.device = flight.properties(schema.DEVICE)
        self.started_ns = _started_ns(flight, self.properties)
        self._asked = asked
        self.tables = tuple(self._tables())
        self.states = tuple(self._states())
        self.events = tuple(self._events())
        if not any(map(self._wanted, flight.entities)):
            raise InputError(
                f"{flight.path}: has no entity like {' '.join(asked.globs)}; docs/logs.md lists them."
            )
        # A state that only goes on is no reason to write it.
        changed = any(t > asked.start for state in self.states for t, _ in state.changes)
        if not (self.tables or self.events or changed):
            raise InputError(
                f"{flight.path}: holds nothing of that between --start and --end; choose others."
            )

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of all rows, or those asked for, s."""
        times = [t for table in self.tables for t in (table.t[0], table.t[-1])]
        times += [t for state in self.states for t, _ in state.changes]
        times += [line.t for line in self.events]
        start, end = self._asked.start, self._asked.end
        return (start if math.isfinite(start) else min(times)), (end if math.isfinite(end) else max(times))

    @property
    def unknown(self) -> tuple[str, ...]:
        """Entities that no schema up to this program's knows, so that they cannot be exported.

        The scene (`/world`) is none of them: it is made of what is exported.
        """
        known = (
            {quantity.path for quantity in schema.QUANTITIES} | {lane.path for lane in LANES} | set(_WORDS)
        )
        ours = (f"{entities.WORLD}/", f"{entities.EVENTS}/", f"{schema.PROCESSES}/")
        return tuple(path for path in self.flight.entities if path not in known and not path.startswith(ours))

    def described(self) -> dict[str, Any]:
        """Return all that the recording says of itself, mission and settings as tables."""
        facts = dict(self.properties)
        mission, settings = (
            json.loads(facts.pop(f"{name}_json", "null")) for name in ("mission", "settings")
        )
        return {"flight": facts, "device": self.device, "mission": mission, "settings": settings}

    def _tables(self) -> Iterator[Table]:
        for quantity in (*schema.QUANTITIES, *self._heartbeats()):
            if not self._wanted(quantity.path):
                continue
            t, values = self.flight.series(quantity)
            first, last = self._places(t)
            if last > first:
                yield Table(quantity, t[first:last], values[first:last])

    def _heartbeats(self) -> Iterator[Quantity]:
        for path in self.flight.entities:
            if path.startswith(f"{schema.PROCESSES}/"):
                yield schema.heartbeat(path.rpartition("/")[2])

    def _states(self) -> Iterator[Changes]:
        """Yield the changes in the time, and before them what held when it began."""
        lanes = [(lane.path, lane.meaning, self.flight.states(lane)) for lane in LANES]
        words = [
            (path, meaning, [(line.t, line.text) for line in sorted(self.flight.texts(path))])
            for path, meaning in _WORDS.items()
        ]
        for path, meaning, changes in (*lanes, *words):
            if not self._wanted(path):
                continue
            before = [change for change in changes if change[0] <= self._asked.start][-1:]
            within = [change for change in changes if self._asked.start < change[0] <= self._asked.end]
            held = [(self._asked.start, word) for _, word in before]
            if held or within:
                yield Changes(path, meaning, [*held, *within])

    def _events(self) -> Iterator[Line]:
        for line in self.flight.events():
            if (
                self._wanted(f"{entities.EVENTS}/{line.source}")
                and self._asked.start <= line.t <= self._asked.end
            ):
                yield line

    def _wanted(self, path: str) -> bool:
        globs = self._asked.globs
        return not globs or any(fnmatchcase(path.lstrip("/"), glob.lstrip("/")) for glob in globs)

    def _places(self, t: Numbers) -> tuple[int, int]:
        first = np.searchsorted(t, self._asked.start, side="left")
        return int(first), int(np.searchsorted(t, self._asked.end, side="right"))


def nanoseconds(t: Numbers | float) -> Any:  # noqa: ANN401 - int64, or an array of them
    """Return times of the timeline as the whole nanoseconds they were recorded with."""
    return np.rint(np.asarray(t) * 1e9).astype(np.int64)


def unit_of(quantity: Quantity, place: int) -> str:
    """Return the unit of a part: "m, rad" of four parts means rad for the last and m for the others."""
    units = quantity.unit.split(", ")
    return units[max(0, place - (len(quantity.parts) - len(units)))]


def _started_ns(flight: Flight, properties: dict[str, Any]) -> int:
    try:
        started = datetime.datetime.fromisoformat(properties["started"])
    except (KeyError, ValueError) as error:
        raise InputError(
            f"{flight.path}: does not say when it was flown; it is no recording of ours, or has lost its start."
        ) from error
    whole = started.replace(microsecond=0)
    return int(whole.timestamp()) * 1_000_000_000 + started.microsecond * 1000
