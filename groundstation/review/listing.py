"""The flights in a folder."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from pathlib import Path

from groundstation.errors import InputError
from groundstation.recording import schema
from groundstation.recording.parts import is_part, parts_of


@dataclass(frozen=True, slots=True)
class Entry:
    """A recorded flight.

    Attributes:
        path: The recording.
        started: When the flight was started, or, of a recording that did not end properly, last written.
        size: Bytes, of all parts.
        mission: The mission's name; "" for none or not known.
        whole: It ended properly.
    """

    path: Path
    started: datetime.datetime
    size: int
    mission: str
    whole: bool


def list_flights(folder: Path) -> list[Entry]:
    """Return the flights in a folder, newest first. Files that are no recordings are passed over.

    Args:
        folder: Where to look; one that is not there has no flights.
    """
    paths = [path for path in folder.glob("*.rrd") if _is_first(path)]
    entries = [entry for path in paths if (entry := _entry(path))]
    return sorted(entries, key=lambda entry: entry.started, reverse=True)


def _is_first(path: Path) -> bool:
    return not path.name.startswith(".") and not is_part(path) and path.is_file()


def _entry(path: Path) -> Entry | None:
    from groundstation.review.flight import properties_of
    from groundstation.review.rrd import is_whole, open_reader

    try:
        reader = open_reader(path)
        status = path.stat()
        _, *later = parts_of(path)
        size = status.st_size + sum(part.stat().st_size for part in later)
    except (InputError, OSError):
        return None
    written = datetime.datetime.fromtimestamp(status.st_mtime).astimezone()
    if not is_whole(reader):
        return Entry(path, written, size, "", whole=False)
    store = reader.store()
    flight = properties_of(store.stream().filter(content=f"/__properties/{schema.FLIGHT}").to_chunks())
    started = datetime.datetime.fromisoformat(flight["started"]) if "started" in flight else written
    return Entry(path, started, size, str(flight.get("mission", "")), whole=all(map(_ended, later)))


def _ended(part: Path) -> bool:
    from groundstation.review.rrd import is_whole, open_reader

    try:
        return is_whole(open_reader(part))
    except InputError:
        return False
