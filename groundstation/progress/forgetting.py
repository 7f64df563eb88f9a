"""`groundstation progress forget`: removes all that the store has of a pilot, once it is sure that it is meant."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from groundstation.errors import InputError
from groundstation.progress.flown import Flown
from groundstation.progress.store import Store
from groundstation.progress.words import counted

EXIT_NOT_DONE = 1


def forget(store: Store, flights: Sequence[Flown], folder: Path, *, sure: bool) -> int:
    """Remove the pilot of these flights, and say what else bears the name; return the exit code.

    Args:
        store: Where from.
        flights: All of one pilot.
        folder: Where recordings are.
        sure: Do not have the name typed.

    Raises:
        InputError: Nobody can be asked.
    """
    pilot = flights[0].pilot
    if not sure and not _typed(pilot, len(flights)):
        print("Nothing was removed.")
        return EXIT_NOT_DONE
    store.forget(pilot)
    print(f"{pilot}: {counted(len(flights), 'flight')} removed from the store.")
    recordings = sorted({each.recording for each in flights if (folder / each.recording).is_file()})
    if recordings:
        still = counted(len(recordings), "recording")
        print(f"{still} in {folder} with the name; 'progress import' would read them again:")
        print("\n".join(f"  {name}" for name in recordings))
    return 0


def _typed(pilot: str, flights: int) -> bool:
    if not sys.stdin.isatty():
        raise InputError(f"forgetting {pilot} asks back, and there is no terminal; add --yes.")
    question = f"Remove {counted(flights, 'flight')} of {pilot}, for good? Type the name: "
    try:
        return input(question).strip().casefold() == pilot.casefold()
    except EOFError:
        print()
        return False
