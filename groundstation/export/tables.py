"""A selection as Arrow tables: one a quantity, events, states; or one wide table on a grid of times."""

# pyarrow has no types.
# pyright: reportUnknownParameterType=false
from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from groundstation.errors import InputError
from groundstation.export.selection import Changes, Selection, Table, nanoseconds, unit_of
from groundstation.recording import schema
from groundstation.review.flight import Line, Numbers

_TIME = "wall-clock time"
# More rows than this are a mistake in --hz.
_MOST_ROWS = 100_000_000


class Column(NamedTuple):
    """What a column of a table holds, for people.

    Attributes:
        table: Its file without suffix; "all" for every one.
        column: Its name.
        unit: Of its numbers, or "".
        rows: How often one comes.
        meaning: What it is.
    """

    table: str
    column: str
    unit: str
    rows: str
    meaning: str


def file_of(path: str) -> str:
    """Return an entity's name for a file, without suffix: "/handle/force" is "handle.force"."""
    return path.strip("/").replace("/", ".")


def column_of(part: str) -> str:
    """Return a part's name for a column: "yaw rate" is "yaw_rate", "5°" is "5deg"."""
    return part.replace("°", "deg").replace("'", "").replace(" ", "_")


def numbers(table: Table, started_ns: int) -> pa.Table:
    """Return a quantity's rows, a column a part, with units and meaning in the schema."""
    quantity = table.quantity
    fields, columns = _times(table.t, started_ns)
    for place, part in enumerate(quantity.parts):
        fields.append(pa.field(column_of(part), pa.float64(), metadata={"unit": unit_of(quantity, place)}))
        columns.append(pa.array(np.ascontiguousarray(table.values[:, place])))
    told = {
        "entity": quantity.path,
        "unit": quantity.unit,
        "rate": quantity.rate,
        "meaning": quantity.meaning,
    }
    return pa.table(columns, schema=pa.schema(fields, metadata=told))


def events(lines: tuple[Line, ...], started_ns: int) -> pa.Table:
    """Return events, commands and answers."""
    fields, columns = _times(np.array([line.t for line in lines], dtype=np.float64), started_ns)
    for name in ("level", "source", "text"):
        fields.append(pa.field(name, pa.string()))
        columns.append(pa.array([getattr(line, name) for line in lines], pa.string()))
    return pa.table(columns, schema=pa.schema(fields))


def states(changes: tuple[Changes, ...], started_ns: int) -> pa.Table:
    """Return when which state came to be what."""
    rows = sorted((t, path, word) for path, _, found in changes for t, word in found)
    fields, columns = _times(np.array([t for t, _, _ in rows], dtype=np.float64), started_ns)
    for name, place in (("state", 1), ("value", 2)):
        fields.append(pa.field(name, pa.string()))
        columns.append(pa.array([row[place] for row in rows], pa.string()))
    return pa.table(columns, schema=pa.schema(fields))


def wide(selection: Selection, hz: float) -> pa.Table:
    """Return one table on a grid: at each time what had last been recorded. Nothing is interpolated.

    What was not known (NaN) stays so; before a quantity's first row there is nothing.

    Args:
        selection: What to take.
        hz: Rows a second.

    Raises:
        InputError: That would be too many rows.
    """
    start, end = selection.span
    # On multiples of the period, so that the tables of several flights are alike.
    first, last = math.ceil(start * hz - 1e-9), math.floor(end * hz + 1e-9)
    rows = last - first + 1
    if rows > _MOST_ROWS:
        raise InputError(f"--hz {hz:g}: would make {rows} rows; choose fewer, or less time.")
    t = np.arange(first, last + 1) / hz
    fields, columns = _times(t, selection.started_ns)
    for table in selection.tables:
        places = _held(table.t, t)
        for place, part in enumerate(table.quantity.parts):
            told = {"unit": unit_of(table.quantity, place), "meaning": table.quantity.meaning}
            fields.append(pa.field(_wide_name(table, part), pa.float64(), metadata=told))
            values = table.values[np.maximum(places, 0), place]
            columns.append(pa.array(values, mask=places < 0))
    for path, meaning, changes in selection.states:
        places = _held(np.array([t for t, _ in changes]), t)
        words = np.array([word for _, word in changes], dtype=object)
        fields.append(pa.field(file_of(path), pa.string(), metadata={"meaning": meaning}))
        columns.append(pa.array(words[np.maximum(places, 0)], pa.string(), mask=places < 0))
    return pa.table(columns, schema=pa.schema(fields))


def columns(selection: Selection, *, in_one: bool) -> Iterator[Column]:
    """Yield what the columns of all tables are, or of the one wide table."""
    every = "all" if not in_one else selection.flight.path.stem
    yield Column(every, "t", "s", "", "Time since the run was started")
    yield Column(every, "time", "", "", f"The same as {_TIME}, UTC")
    for table in selection.tables:
        quantity = table.quantity
        for place, part in enumerate(quantity.parts):
            name = _wide_name(table, part) if in_one else column_of(part)
            file = every if in_one else file_of(quantity.path)
            yield Column(file, name, unit_of(quantity, place), quantity.rate, quantity.meaning)
    for path, meaning, _ in selection.states if in_one else ():
        yield Column(every, file_of(path), "", "on change", meaning)


def _wide_name(table: Table, part: str) -> str:
    return f"{file_of(table.quantity.path)}.{column_of(part)}"


def _times(t: Numbers, started_ns: int) -> tuple[list[pa.Field], list[pa.Array]]:
    clock = pa.array(nanoseconds(t) + started_ns).cast(pa.timestamp("ns", "UTC"))
    fields = [
        pa.field("t", pa.float64(), metadata={"unit": "s", "timeline": schema.TIMELINE}),
        pa.field("time", clock.type, metadata={"meaning": _TIME}),
    ]
    return fields, [pa.array(t), clock]


def _held(t: Numbers, at: Numbers) -> np.ndarray:
    """Return which row held at each time: the newest that is not later, to the nanosecond; −1 before the first."""
    return np.searchsorted(t, at + 0.5e-9, side="right") - 1
