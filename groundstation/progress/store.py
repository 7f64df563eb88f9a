"""What pilots flew, in one SQLite file beside the recordings. Several programs may have it open at once.

It can be made anew from the recordings at any time (`groundstation progress import`), but for the forms on workload.
"""

from __future__ import annotations

import contextlib
import datetime
import sqlite3
from collections.abc import Generator, Iterable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import msgspec

from groundstation.progress.flown import Flown
from groundstation.progress.opening import DamagedError, connect, move_aside, unusable
from groundstation.training.measures import Track
from groundstation.training.workload import Workload

_COLUMNS = (
    "started",
    "attempt",
    "mission",
    "digest",
    "seed",
    "simulated",
    "device",
    "duration_s",
    "passed",
    "points",
    "parts",
    "measures",
    "recording",
    "program",
    "instructed",
)
_FLAGS = ("simulated", "passed", "instructed")
_TABLES = ("parts", "measures")
_SCALES = Workload.__struct_fields__


class Store:
    """A store that is open; use it in a `with` block.

    Args:
        path: Its file; made where it is missing.

    Raises:
        InputError: It cannot be used.

    Attributes:
        words: What befell the file when it was opened, for people; "" for nothing.
    """

    def __init__(self, path: Path) -> None:
        self._path, self.words = path, ""
        try:
            self._connection = connect(path)
        except DamagedError:
            self.words = move_aside(path, datetime.datetime.now().astimezone())
            try:
                self._connection = connect(path)
            except DamagedError as error:
                raise unusable(path, error) from error
        self._connection.row_factory = sqlite3.Row

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._connection.close()

    def add(self, flown: Flown, track: Track | None = None) -> int:
        """Keep a flight; return its number. One that is known already stays as it is.

        Raises:
            InputError: It cannot be written.
        """
        row = _row(flown)
        with self._writing() as write:
            write.execute("INSERT INTO pilots (name) VALUES (?) ON CONFLICT DO NOTHING", (flown.pilot,))
            pilot = write.execute("SELECT id FROM pilots WHERE name = ?", (flown.pilot,)).fetchone()["id"]
            names, places = ", ".join(_COLUMNS), ", ".join("?" * len(_COLUMNS))
            new = write.execute(
                f"INSERT INTO flights (pilot, {names}) VALUES (?, {places}) ON CONFLICT DO NOTHING",  # noqa: S608
                (pilot, *row),
            ).rowcount
            number = int(
                write.execute(
                    "SELECT id FROM flights WHERE pilot = ? AND started = ? AND attempt = ?",
                    (pilot, flown.started, flown.attempt),
                ).fetchone()["id"]
            )
            if new and track is not None:
                write.execute(
                    "INSERT INTO tracks VALUES (?, ?)", (number, msgspec.json.encode(track).decode())
                )
        return number

    def knows(self, flown: Flown) -> bool:
        """Say whether a flight is kept already."""
        return any(
            (each.started, each.attempt) == (flown.started, flown.attempt)
            for each in self.flights(flown.pilot)
        )

    def pilots(self) -> list[str]:
        """Return the names of all pilots, in the order of the alphabet."""
        return [row["name"] for row in self._read("SELECT name FROM pilots ORDER BY name COLLATE NOCASE")]

    def flights(self, pilot: str | None = None, mission: str | None = None) -> list[Flown]:
        """Return the flights kept, oldest first; all, or one pilot's, or of one mission."""
        rows = self._read(
            "SELECT flights.*, pilots.name FROM flights JOIN pilots ON pilots.id = flights.pilot"
            " WHERE (?1 IS NULL OR pilots.name = ?1 COLLATE NOCASE) AND (?2 IS NULL OR mission = ?2)",
            (pilot, mission),
        )
        found = [_flown(row) for row in rows]
        # By the moment and not by the letters: clocks are put forward and back.
        return sorted(
            found, key=lambda each: (datetime.datetime.fromisoformat(each.started), each.attempt, each.number)
        )

    def best(self, pilot: str, mission: str, digest: str | None = None) -> Flown | None:
        """Return a pilot's best flight of a mission without an instructor's doing, passed before not passed, or None.

        Args:
            pilot: Who.
            mission: Its name.
            digest: Only flights of the mission as it is with this one.
        """
        scored = [
            each
            for each in self.flights(pilot, mission)
            if each.points is not None and not each.instructed and digest in (None, each.digest)
        ]
        return max(scored, key=lambda each: (each.passed is True, each.points or 0.0), default=None)

    def track(self, number: int) -> Track | None:
        """Return where a flight went, by its number; None where that was not kept."""
        rows = self._read("SELECT track FROM tracks WHERE flight = ?", (number,))
        return msgspec.json.decode(rows[0]["track"], type=Track) if rows else None

    def set_workload(self, number: int, workload: Workload) -> None:
        """Keep how hard a flight felt; what was said of it before is replaced.

        Raises:
            InputError: It cannot be written, or there is no such flight.
        """
        places = ", ".join("?" * (len(_SCALES) + 1))
        with self._writing() as write:
            write.execute(
                f"INSERT OR REPLACE INTO workload (flight, {', '.join(_SCALES)}) VALUES ({places})",  # noqa: S608
                (number, *msgspec.structs.astuple(workload)),
            )

    def workloads(self, pilot: str) -> dict[int, Workload]:
        """Return how hard a pilot's flights felt, by their number."""
        rows = self._read(
            "SELECT workload.* FROM workload JOIN flights ON flights.id = workload.flight"
            " JOIN pilots ON pilots.id = flights.pilot WHERE pilots.name = ? COLLATE NOCASE",
            (pilot,),
        )
        return {row["flight"]: Workload(*(row[scale] for scale in _SCALES)) for row in rows}

    def forget(self, pilot: str) -> int:
        """Remove a pilot and all that is kept of them; return how many flights that were.

        Raises:
            InputError: It cannot be written.
        """
        count = len(self.flights(pilot))
        with self._writing() as write:
            write.execute("DELETE FROM pilots WHERE name = ? COLLATE NOCASE", (pilot,))
        # Out of the log of changes, too.
        self._read("PRAGMA wal_checkpoint(TRUNCATE)")
        return count

    def _read(self, query: str, values: Iterable[Any] = ()) -> list[sqlite3.Row]:
        try:
            return self._connection.execute(query, tuple(values)).fetchall()
        except sqlite3.DatabaseError as error:
            raise unusable(self._path, error) from error

    @contextlib.contextmanager
    def _writing(self) -> Generator[sqlite3.Connection]:
        """Change all or nothing; others wait meanwhile."""
        try:
            self._connection.execute("BEGIN IMMEDIATE")
            with self._connection:
                yield self._connection
        except sqlite3.DatabaseError as error:
            raise unusable(self._path, error) from error


def _row(flown: Flown) -> list[Any]:
    fields = msgspec.structs.asdict(flown)
    for name in _TABLES:
        fields[name] = msgspec.json.encode(fields[name]).decode()
    return [fields[name] for name in _COLUMNS]


def _flown(row: sqlite3.Row) -> Flown:
    fields = {name: row[name] for name in _COLUMNS}
    for name in _FLAGS:
        fields[name] = None if fields[name] is None else bool(fields[name])
    for name in _TABLES:
        fields[name] = msgspec.json.decode(fields[name], type=dict[str, float])
    return Flown(pilot=row["name"], number=row["id"], **fields)
