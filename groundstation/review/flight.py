"""A recorded flight as NumPy arrays, by the entities of `groundstation.recording.schema` and `lanes`."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt
from rerun.chunk import Chunk

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.recording import entities, schema
from groundstation.recording.lanes import Lane
from groundstation.recording.schema import Quantity
from groundstation.review.earlier import settings_from
from groundstation.review.rrd import read_chunks
from groundstation.shown import shown
from groundstation.training.measures import Measures
from groundstation.training.mission import Mission
from sim.scenario import not_printable

Numbers = npt.NDArray[np.float64]

_SCALARS = "Scalars:scalars"
_STATE = "StateChange:state"
_TEXT, _LEVEL = "TextLog:text", "TextLog:level"
_PROPERTIES = "/__properties"


class Series(NamedTuple):
    """Numbers over time.

    Attributes:
        t: (n,), s since the run was started, ascending.
        values: (n, k), a column a part of the quantity, in its units.
    """

    t: Numbers
    values: Numbers


class Line(NamedTuple):
    """An event: when (s), its level, who told it, and its words."""

    t: float
    level: str
    source: str
    text: str


class Flight:
    """One recording, read whole into memory, however it ended.

    Args:
        path: The `.rrd` file.

    Raises:
        InputError: It is missing or not a recording.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._timed: dict[str, list[Chunk]] = {}
        self._static: dict[str, list[Chunk]] = {}
        for chunk in read_chunks(path):
            kind = self._static if chunk.is_static else self._timed
            kind.setdefault(chunk.entity_path, []).append(chunk)

    @property
    def entities(self) -> tuple[str, ...]:
        """Return the paths of all that has rows over time, sorted."""
        return tuple(sorted(self._timed))

    def series(self, quantity: Quantity) -> Series:
        """Return a quantity's rows; none where it was never recorded."""
        width = len(quantity.parts)
        times: list[Numbers] = [np.empty(0)]
        values: list[Numbers] = [np.empty((0, width))]
        for chunk in self._timed.get(quantity.path, ()):
            times.append(_seconds(chunk))
            values.append(chunk.to_record_batch().column(_SCALARS).flatten().to_numpy().reshape(-1, width))
        t, numbers = np.concatenate(times), np.concatenate(values)
        order = np.argsort(t, kind="stable")
        return Series(t[order], numbers[order])

    def clock(self, quantity: Quantity) -> Numbers:
        """Return the times of a quantity's rows on the clock of the machine that flew, (n,), s: the very floats.

        Raises:
            InputError: It was recorded before schema 4, which does not say when it began on that clock.
        """
        since = [_nanoseconds(chunk) for chunk in self._timed.get(quantity.path, ())]
        return (np.sort(np.concatenate([np.empty(0, np.int64), *since])) + self._start_ns) / 1e9

    @property
    def start(self) -> float:
        """When the run was started on that clock, s.

        Raises:
            InputError: It was recorded before schema 4.
        """
        return self._start_ns / 1e9

    def held(self, quantity: Quantity, t: Numbers) -> Numbers:
        """Return what a quantity that is recorded on a change was at given times, (n, parts); NaN before the first.

        Args:
            quantity: What is asked for.
            t: (n,), s on the clock of the machine that flew.

        Raises:
            InputError: It was recorded before schema 4.
        """
        unknown = np.full((1, len(quantity.parts)), np.nan)
        rows = np.concatenate((unknown, self.series(quantity).values))
        return rows[np.searchsorted(self.clock(quantity), t, side="right")]

    @functools.cached_property
    def _start_ns(self) -> int:
        start = self._facts().get("start_ns")
        if start is None:
            raise InputError(
                f"{self.path}: was recorded before schema 4 and lacks what each tick was made from; "
                "leave out --check to fly its hand in the simulator."
            )
        return int(start)

    def states(self, lane: Lane) -> list[tuple[float, str]]:
        """Return a lane's changes: when (s), and to what."""
        return sorted((t, words[_STATE]) for t, words in self._words(lane.path, _STATE))

    def events(self) -> list[Line]:
        """Return all events, commands and answers, in the order of their times."""
        paths = [path for path in self._timed if path.startswith(f"{entities.EVENTS}/")]
        return sorted(line for path in paths for line in self.texts(path))

    def texts(self, path: str) -> list[Line]:
        """Return the lines of one entity of words; the last part of its path tells them."""
        source = path.rpartition("/")[2]
        return [Line(t, words[_LEVEL], source, words[_TEXT]) for t, words in self._words(path, _TEXT, _LEVEL)]

    def properties(self, name: str = schema.FLIGHT) -> dict[str, Any]:
        """Return the recorder's properties of the flight, or those of the device."""
        return properties_of(self._static.get(f"{_PROPERTIES}/{name}", []))

    @property
    def mission(self) -> Mission | None:
        """The mission flown, or None.

        Raises:
            InputError: The recording is of something else than a flight, or its mission is none.
        """
        tables = msgspec.json.decode(self._facts()["mission_json"])
        if where := not_printable(tables):
            raise InputError(f"{self.path}: its mission's {where} has a control character; it is not used.")
        return msgspec.convert(tables, Mission | None)

    @property
    def par(self) -> Measures | None:
        """What it is held against; None where nobody had flown the mission for reference, and before schema 5."""
        return msgspec.json.decode(self._facts().get("par_json", "null"), type=Measures | None)

    @property
    def settings(self) -> Settings:
        """The settings flown with.

        Raises:
            InputError: The flight was recorded by a later version of this program, or is none.
        """
        return settings_from(self._facts())

    @property
    def duration(self) -> float:
        """From the start of the run to the last row of all, s; 0 of an empty recording."""
        ends = [_seconds(chunk) for chunks in self._timed.values() for chunk in chunks]
        return max((float(times.max()) for times in ends if len(times)), default=0.0)

    def _facts(self) -> dict[str, Any]:
        facts = self.properties()
        if not {"schema", "mission_json", "settings_json"} <= facts.keys():
            raise InputError(
                f"{self.path}: is a Rerun recording, but not of a flight; give one that this program made."
            )
        return facts

    def _words(self, path: str, *components: str) -> Iterator[tuple[float, dict[str, str]]]:
        for chunk in self._timed.get(path, ()):
            rows = chunk.to_record_batch()
            columns = [rows.column(component).to_pylist() for component in components]
            for t, *row in zip(_seconds(chunk), *columns, strict=True):
                yield float(t), {component: cell[0] for component, cell in zip(components, row, strict=True)}


def properties_of(chunks: list[Chunk]) -> dict[str, Any]:
    """Return the properties in static chunks of one property entity, the newest of each."""
    found: dict[str, Any] = {}
    for chunk in chunks:
        rows = chunk.to_record_batch()
        for name in rows.schema.names:
            cell = rows.column(name)[-1].as_py()
            if isinstance(cell, list) and cell:
                found[name] = shown(cell[0]) if isinstance(cell[0], str) else cell[0]
    return found


def _seconds(chunk: Chunk) -> Numbers:
    """Return the times of a chunk's rows, s, on the timeline."""
    return np.asarray(_nanoseconds(chunk) * 1e-9, dtype=float)


def _nanoseconds(chunk: Chunk) -> npt.NDArray[np.int64]:
    return chunk.to_record_batch().column(schema.TIMELINE).cast("int64").to_numpy()
