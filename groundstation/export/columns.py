"""A flight's numbers as tables: every quantity at its own rate, or all of them at one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from typing import NamedTuple

import numpy as np

from groundstation.recording import schema
from groundstation.review.flight import Flight, Numbers


class Columns(NamedTuple):
    """A quantity, or several, over time.

    Attributes:
        path: Entity; "" of several.
        t: (n,), s since the run was started.
        names, units: Of the k columns.
        meaning: What it is.
        values: (n, k).
    """

    path: str
    t: Numbers
    names: Sequence[str]
    units: Sequence[str]
    meaning: str
    values: Numbers


class Span(NamedTuple):
    """What of a flight is exported: entities by patterns, and a time, s."""

    patterns: Sequence[str] = ("*",)
    start: float = 0.0
    end: float = np.inf

    def chooses(self, path: str) -> bool:
        """Say whether an entity is exported."""
        return any(fnmatchcase(path, pattern) for pattern in self.patterns)


def columns_of(flight: Flight, span: Span) -> Iterator[Columns]:
    """Yield the quantities that were recorded, in the schema's order; heartbeats last."""
    beats = [path for path in flight.entities if path.startswith(f"{schema.PROCESSES}/")]
    roles = [schema.heartbeat(path.rpartition("/")[2]) for path in beats]
    for quantity in (*schema.QUANTITIES, *roles):
        t, values = flight.series(quantity)
        inside = (t >= span.start) & (t <= span.end)
        if span.chooses(quantity.path) and inside.any():
            units = units_of(quantity)
            yield Columns(quantity.path, t[inside], quantity.parts, units, quantity.meaning, values[inside])


def units_of(quantity: schema.Quantity) -> list[str]:
    """Return a unit for each part: where a quantity names two, the last part has the second."""
    units = quantity.unit.split(", ")
    return [units[0]] * (len(quantity.parts) - 1) + [units[-1]]


def wide(tables: Sequence[Columns], hz: float) -> Columns:
    """Return all tables as one at a rate: each value as it was last known, NaN before the first."""
    first = min(table.t[0] for table in tables)
    last = max(table.t[-1] for table in tables)
    grid = np.arange(np.ceil(first * hz), np.floor(last * hz) + 1.0) / hz
    parts: list[Numbers] = []
    for table in tables:
        places = np.searchsorted(table.t, grid, side="right") - 1
        held = table.values[np.maximum(places, 0)]
        parts.append(np.where((places >= 0)[:, None], held, np.nan))
    names = [f"{table.path[1:].replace('/', '.')}.{name}" for table in tables for name in table.names]
    units = [unit for table in tables for unit in table.units]
    return Columns("", grid, names, units, "All quantities, as last known", np.hstack(parts))
