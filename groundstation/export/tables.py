"""Parquet and CSV: a folder with a table a quantity, or one wide table; units and meanings go with them."""

from __future__ import annotations

import csv
import datetime
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from groundstation.export.columns import Columns, Span, columns_of, wide
from groundstation.recording.lanes import LANES
from groundstation.review.flight import Flight

_COMPRESSION = "zstd"


def write_folder(flight: Flight, span: Span, out: Path, kind: str) -> Iterator[str]:
    """Write a flight into a new folder, table by table, yielding the name of each.

    Args:
        flight: The flight.
        span: What of it.
        out: The folder, which does not exist.
        kind: "parquet" or "csv".
    """
    out.mkdir(parents=True)
    started = started_of(flight)
    known: list[tuple[str, str, str, str]] = []
    for columns in columns_of(flight, span):
        name = columns.path[1:].replace("/", ".")
        yield name
        _write(_table(columns, started), out / f"{name}.{kind}", kind)
        known += [
            (name, part, unit, columns.meaning)
            for part, unit in zip(columns.names, columns.units, strict=True)
        ]
    for name, table in (("events", _events(flight, span)), ("states", _states(flight, span))):
        yield name
        _write(table, out / f"{name}.{kind}", kind)
    (out / "properties.json").write_text(json.dumps(properties_of(flight), indent=1), encoding="utf-8")
    with (out / "columns.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([("table", "column", "unit", "meaning"), *known])


def write_wide(flight: Flight, span: Span, out: Path, hz: float, kind: str) -> Iterator[str]:
    """Write a flight as one table at a rate, "parquet" or "csv"; see `write_folder`."""
    yield "one table"
    _write(_table(wide(list(columns_of(flight, span)), hz), started_of(flight)), out, kind)


def started_of(flight: Flight) -> datetime.datetime:
    """Return when the run was started; 1970 where the recording does not say."""
    words = flight.properties().get("started")
    return (
        datetime.datetime.fromisoformat(str(words))
        if words
        else datetime.datetime.fromtimestamp(0, datetime.UTC)
    )


def properties_of(flight: Flight) -> dict[str, Any]:
    """Return what the recording says of flight and device."""
    return {"flight": flight.properties(), "device": flight.properties("device")}


def wall_ns(t: np.ndarray, started: datetime.datetime) -> np.ndarray:
    """Return wall-clock times, ns since 1970, of times since the start, s."""
    start_us = round(started.timestamp() * 1e6)
    return start_us * 1000 + np.rint(t * 1e9).astype(np.int64)


def _table(columns: Columns, started: datetime.datetime) -> Any:
    arrays = [pa.array(columns.t), pa.array(wall_ns(columns.t, started), pa.timestamp("ns", "UTC"))]
    arrays += [pa.array(np.ascontiguousarray(column)) for column in columns.values.T]
    fields = [
        pa.field("t", pa.float64(), metadata={"unit": "s"}),
        pa.field("time", pa.timestamp("ns", "UTC")),
    ]
    fields += [
        pa.field(name, pa.float64(), metadata={"unit": unit})
        for name, unit in zip(columns.names, columns.units, strict=True)
    ]
    return pa.table(
        arrays, schema=pa.schema(fields, metadata={"meaning": columns.meaning, "entity": columns.path})
    )


def _events(flight: Flight, span: Span) -> Any:
    lines = [line for line in flight.events() if span.start <= line.t <= span.end]
    return pa.table(
        {
            "t": pa.array([line.t for line in lines], pa.float64()),
            "level": pa.array([line.level for line in lines], pa.string()),
            "source": pa.array([line.source for line in lines], pa.string()),
            "text": pa.array([line.text for line in lines], pa.string()),
        }
    )


def _states(flight: Flight, span: Span) -> Any:
    rows: Sequence[tuple[float, str, str]] = sorted(
        (t, lane.path, word)
        for lane in LANES
        for t, word in flight.states(lane)
        if span.start <= t <= span.end
    )
    return pa.table(
        {
            "t": pa.array([row[0] for row in rows], pa.float64()),
            "state": pa.array([row[1] for row in rows], pa.string()),
            "value": pa.array([row[2] for row in rows], pa.string()),
        }
    )


def _write(table: Any, path: Path, kind: str) -> None:
    if kind == "parquet":
        pyarrow.parquet.write_table(table, path, compression=_COMPRESSION)
    else:
        pyarrow.csv.write_csv(table, path)
