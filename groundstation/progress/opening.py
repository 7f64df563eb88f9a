"""Opens the store's file: made where it is missing, brought up to date; damaged it is moved aside, never deleted."""

from __future__ import annotations

import contextlib
import datetime
import fcntl
import os
import sqlite3
from collections.abc import Generator
from pathlib import Path

from groundstation.errors import InputError
from groundstation.progress.tables import STEPS, VERSION

FILE = "progress.sqlite"
# Others write for milliseconds; who waits longer than this for its turn has met something that hangs, s.
_WAIT_S = 10.0
_PARTS = ("", "-wal", "-shm")


class DamagedError(sqlite3.DatabaseError):
    """The file is no database any more, or a torn one."""


def store_in(folder: Path) -> Path:
    """Return where the store of a folder of recordings is."""
    return folder / FILE


def connect(path: Path) -> sqlite3.Connection:
    """Return a connection to a store of today's version.

    Raises:
        InputError: It cannot be opened, or a later version of this program wrote it.
        DamagedError: See there.
    """
    try:
        connection = sqlite3.connect(path, timeout=_WAIT_S, isolation_level=None)
    except sqlite3.OperationalError as error:
        raise unusable(path, error) from error
    try:
        _prepare(connection, path)
    except BaseException:
        connection.close()
        raise
    return connection


def _prepare(connection: sqlite3.Connection, path: Path) -> None:
    try:
        # Of several programs one writes while the others read; what is forgotten is overwritten on the disk, too.
        for setting in ("journal_mode = WAL", "foreign_keys = ON", "secure_delete = ON"):
            connection.execute(f"PRAGMA {setting}")
        (verdict,) = connection.execute("PRAGMA quick_check(1)").fetchone()
        version = _version(connection)
        if version < VERSION:
            _bring_up_to_date(connection)
    except sqlite3.OperationalError as error:
        raise unusable(path, error) from error
    except sqlite3.DatabaseError as error:
        raise DamagedError(str(error)) from error
    if verdict != "ok":
        raise DamagedError(str(verdict))
    if version > VERSION:
        raise InputError(
            f"{path}: was written by a later version of this program (format {version}, this one knows {VERSION}); "
            "use that version, or choose another --logs."
        )


def _bring_up_to_date(connection: sqlite3.Connection) -> None:
    """Do the steps that are missing, in one go: of several programs that begin at once the first does them."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        for step in STEPS[_version(connection) :]:
            for statement in filter(str.strip, step.split(";")):
                connection.execute(statement)
        connection.execute(f"PRAGMA user_version = {VERSION}")
        connection.execute("COMMIT")
    except BaseException:
        connection.execute("ROLLBACK")
        raise


def _version(connection: sqlite3.Connection) -> int:
    return int(connection.execute("PRAGMA user_version").fetchone()[0])


def move_aside(path: Path, now: datetime.datetime) -> str:
    """Move a damaged store out of the way and return what became of it, in words; "" where somebody else has.

    Raises:
        InputError: It cannot be moved.
    """
    aside = path.with_name(f"{path.name}.damaged-{now:%Y-%m-%d_%H-%M-%S_%f}")
    try:
        with _alone_in(path.parent):
            with contextlib.suppress(DamagedError):
                connect(path).close()
                return ""
            for part in _PARTS:
                with contextlib.suppress(FileNotFoundError):
                    path.with_name(path.name + part).rename(aside.with_name(aside.name + part))
    except OSError as error:
        raise InputError(
            f"{path}: is damaged and cannot be moved aside ({error.strerror}); move it yourself."
        ) from error
    return (
        f"{path}: was damaged and is now {aside.name}; a new one was begun, "
        "and 'groundstation progress import' fills it from the recordings."
    )


@contextlib.contextmanager
def _alone_in(folder: Path) -> Generator[None]:
    """Keep other programs from moving the same file: the second would move the new one."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def unusable(path: Path, error: sqlite3.Error) -> InputError:
    """Return what is said of a store that can be neither read nor written."""
    return InputError(
        f"{path}: progress cannot be kept there ({error}); make file and folder writable, or choose another --logs."
    )
