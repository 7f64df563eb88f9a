"""Which recorded flight is meant: by its path, by its place in the list, or the newest."""

from __future__ import annotations

from pathlib import Path

from groundstation.errors import InputError
from groundstation.review.listing import list_flights


def chosen(named: Path | None, folder: Path) -> Path:
    """Return the recording that is meant.

    Args:
        named: A recording; a number, as `review --list` shows them; None for the newest.
        folder: Where recordings are.

    Raises:
        InputError: There is no such flight.
    """
    if named is not None and named.is_dir():
        raise InputError(f"{named}: is a folder; give a recording, or the folder by --logs for its newest.")
    if named is not None and not (str(named).isdecimal() and not named.exists()):
        return named
    entries = list_flights(folder)
    if not entries:
        raise InputError(f"{folder}: there are no recorded flights; name a recording or choose --logs.")
    place = int(str(named)) if named is not None else 1
    if not 1 <= place <= len(entries):
        raise InputError(
            f"{folder}: has {len(entries)} flights, no number {place}; 'review --list' shows them."
        )
    return entries[place - 1].path
