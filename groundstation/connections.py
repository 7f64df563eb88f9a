"""The last connections to real vehicles, kept beside the recordings so that they need not be typed again."""

from __future__ import annotations

from pathlib import Path

import msgspec
from msgspec import Struct

_FILE = "connections.json"
_KEPT = 6


class Connection(Struct, frozen=True):
    """A connection that was flown by: as for `--connect`, `--device`, `--mission`; `day` is its date."""

    url: str
    device: str = ""
    mission: str = ""
    day: str = ""


def recent(folder: Path) -> list[Connection]:
    """Return the last connections, newest first; a file that cannot be read is as if there were none."""
    try:
        return msgspec.json.decode((folder / _FILE).read_bytes(), type=list[Connection])
    except (OSError, msgspec.DecodeError):
        return []


def remember(folder: Path, connection: Connection) -> None:
    """Put a connection first.

    Raises:
        OSError: The folder cannot be written.
    """
    kept = [connection, *(each for each in recent(folder) if each.url != connection.url)][:_KEPT]
    new = folder / f"{_FILE}.new"
    new.write_bytes(msgspec.json.format(msgspec.json.encode(kept)))
    new.replace(folder / _FILE)
