"""Tables as files: a folder of them with what they mean beside, or one wide table."""

# pyarrow has no types.
# pyright: reportUnknownParameterType=false
from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from groundstation.export import tables
from groundstation.export.output import MARK
from groundstation.export.selection import Selection

Tell = Callable[[str], None]
COLUMNS = "columns"
_README = """\
{stem}: a flight recorded by groundstation, exported as {suffix}.

{rows}
events.{suffix}      what was told, commands and their answers
states.{suffix}      when which state came to be what
columns.csv     what every column holds, with its unit
properties.json   the recording's properties, with mission and settings

t is the time since the run was started, s; time the same on the wall clock, UTC. World: x east, y north, z up, from
where the vehicle was first armed. Vehicle: forward, left, up, turned by its yaw only. Handle: x toward the drone's
front, y left, z up. Angles in rad, counter-clockwise. NaN was not known; infinite distance: nothing is there.
"""


def save(table: pa.Table, path: Path, suffix: str) -> None:
    """Write a table as "csv" or "parquet"; numbers come back to the last bit from either."""
    if suffix == "csv":
        pyarrow.csv.write_csv(table, path)
    else:
        pyarrow.parquet.write_table(table, path, compression="zstd")


def write_folder(selection: Selection, folder: Path, suffix: str, tell: Tell) -> None:
    """Write a table a quantity, events, states, properties and what all of it means into a folder that is there."""
    started = selection.started_ns
    for table in selection.tables:
        tell(table.quantity.path)
        save(
            tables.numbers(table, started), folder / f"{tables.file_of(table.quantity.path)}.{suffix}", suffix
        )
    if selection.events:
        save(tables.events(selection.events, started), folder / f"events.{suffix}", suffix)
    if selection.states:
        save(tables.states(selection.states, started), folder / f"states.{suffix}", suffix)
    save(described(selection, in_one=False), folder / f"{COLUMNS}.csv", "csv")
    words = _README.format(stem=selection.flight.path.stem, suffix=suffix, rows=_rows(selection, suffix))
    (folder / "README.txt").write_text(words, encoding="utf-8")
    told = json.dumps(selection.described(), indent=2, ensure_ascii=False)
    (folder / MARK).write_text(told + "\n", encoding="utf-8")


def write_wide(selection: Selection, path: Path, hz: float, suffix: str) -> None:
    """Write one table on a grid."""
    table = tables.wide(selection, hz)
    facts = {name: str(value) for name, value in selection.properties.items()}
    save(table.replace_schema_metadata(facts), path, suffix)


def described(selection: Selection, *, in_one: bool) -> pa.Table:
    """Return what the columns hold as a table itself."""
    rows = list(tables.columns(selection, in_one=in_one))
    return pa.table({name: [getattr(row, name) for row in rows] for name in tables.Column._fields})


def _rows(selection: Selection, suffix: str) -> str:
    return "\n".join(
        f"{tables.file_of(table.quantity.path)}.{suffix}: {len(table.t)} rows. {table.quantity.meaning}."
        for table in selection.tables
    )
