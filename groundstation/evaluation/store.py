"""Keeps what has been flown: a log that survives whatever ends the program, and the table made from it.

A result is one line of JSON, appended and handed to the system at once. A line that was cut short, as by a full disk
or SIGKILL, is dropped when the log is opened again, and its flight flown anew.
"""

from __future__ import annotations

import csv
import fcntl
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, get_type_hints

import msgspec

from groundstation.errors import InputError
from groundstation.evaluation.case import Case, Outcome, Result

if TYPE_CHECKING:
    from pyarrow import Schema

PARQUET, CSV = ".parquet", ".csv"
LOG = ".jsonl"

# Column and the field it comes from; units are in the names.
CASE_COLUMNS = {
    "controller": "controller",
    "guard": "guard",
    "mission": "mission",
    "delay_s": "delay",
    "jitter_s": "jitter",
    "loss": "loss",
    "wind": "wind",
    "operator": "operator",
    "seed": "seed",
    "rate_hz": "rate",
    "airframe": "airframe",
    "model": "model",
}
OUTCOME_COLUMNS = {
    "completed": "completed",
    "time_s": "time",
    "rms_error_m": "rms_error",
    "clearance_m": "clearance",
    "collisions": "collisions",
    "max_force_n": "max_force",
    "mean_force_n": "mean_force",
    "hand_work_j": "hand_work",
    "dissipated_j": "dissipated",
    "disagreement_m_s": "disagreement",
    "uncoupled": "uncoupled",
    "flown_s": "flown",
    "processor_s": "processor",
    "reason": "reason",
}


class Log:
    """The log next to the table.

    Args:
        path: Of the log; it is made if it is not there.

    Attributes:
        results: What it held when it was opened, by id.

    Raises:
        InputError: It cannot be written, another evaluation writes it, or it is something else.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._encoder = msgspec.json.Encoder()
        try:
            self._file: BinaryIO = path.open("a+b", buffering=0)
        except OSError as error:
            raise InputError(
                f"{path}: cannot be written ({error.strerror}); choose another place with --out."
            ) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._file.close()
            raise InputError(
                f"{path}: another evaluation is writing it; wait, or choose another --out."
            ) from error
        self.results = self._read()

    def add(self, result: Result) -> None:
        """Append a result; afterwards it outlives this process."""
        self._file.write(self._encoder.encode(result) + b"\n")

    def close(self) -> None:
        """Hand everything to the disk and let the log go."""
        os.fsync(self._file.fileno())
        self._file.close()

    def _read(self) -> dict[str, Result]:
        self._file.seek(0)
        content = self._file.read()
        whole = content.rfind(b"\n") + 1
        if whole < len(content):
            self._file.truncate(whole)
        decoder = msgspec.json.Decoder(Result)
        try:
            results = [decoder.decode(line) for line in content[:whole].splitlines()]
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            self._file.close()
            raise InputError(
                f"{self.path}: is no log of this version of evaluate ({error}); move it away or choose another --out."
            ) from error
        return {result.id: result for result in results}


def write_table(path: Path, results: Iterable[Result]) -> None:
    """Write the table, in full or not at all: Parquet or CSV by the suffix. What does not exist is left empty."""
    rows = [row(result) for result in results]
    draft = path.with_name(f".{path.name}.part")
    if path.suffix == CSV:
        with draft.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, [*CASE_COLUMNS, *OUTCOME_COLUMNS])
            writer.writeheader()
            writer.writerows(rows)
    else:
        import pyarrow as pa
        from pyarrow import parquet

        parquet.write_table(pa.Table.from_pylist(rows, schema=_schema()), draft)
    draft.replace(path)


def row(result: Result) -> dict[str, object]:
    """Return a result as a row of the table."""
    case, outcome = result.case, result.outcome
    return {column: getattr(case, field) for column, field in CASE_COLUMNS.items()} | {
        column: getattr(outcome, field) for column, field in OUTCOME_COLUMNS.items()
    }


def _schema() -> Schema:  # pyright: ignore[reportUnknownParameterType] - pyarrow has no types
    import pyarrow as pa

    kinds = {
        bool: pa.bool_(),
        int: pa.int64(),
        float: pa.float64(),
        float | None: pa.float64(),
        str: pa.string(),
    }
    of_case, of_outcome = get_type_hints(Case), get_type_hints(Outcome)
    columns = [(column, kinds[of_case[field]]) for column, field in CASE_COLUMNS.items()]
    return pa.schema(
        columns + [(column, kinds[of_outcome[field]]) for column, field in OUTCOME_COLUMNS.items()]
    )
