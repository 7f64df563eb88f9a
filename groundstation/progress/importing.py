"""`groundstation progress import`: what recordings tell of pilots' flights, into the store. Known flights stay."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from groundstation.errors import InputError
from groundstation.progress.flown import Flown
from groundstation.progress.judging import device_word, judged
from groundstation.progress.store import Store
from groundstation.progress.words import counted
from groundstation.review.flight import Flight
from groundstation.review.listing import list_flights
from groundstation.review.outcome import attempts_of
from groundstation.shown import shown
from groundstation.status_line import StatusLine
from groundstation.training.measurer import Measurer
from groundstation.training.measures import Track
from groundstation.training.reference import digest_of

EXIT_UNREADABLE = 1
# Up to this schema the scripted hand's flights bore the name of who was logged in.
_SCRIPTED_UP_TO = 4


def import_flights(store: Store, files: Sequence[Path], folder: Path) -> int:
    """Add the flights of recordings to the store and tell of it; return the exit code.

    Args:
        store: Where to.
        files: The recordings; none for all of the folder.
        folder: Where recordings are.
    """
    paths = list(files) or [entry.path for entry in reversed(list_flights(folder))]
    added = known = 0
    broken: list[str] = []
    with StatusLine(sys.stderr) as line:
        for number, path in enumerate(paths, 1):
            line.step(f"reading {number} of {len(paths)}: {path.name}")
            try:
                for flown, track in flights_in(path):
                    new = not store.knows(flown)
                    store.add(flown, track)
                    added, known = added + new, known + (not new)
            except InputError as error:
                broken.append(str(error))
    print(
        f"{counted(added, 'flight')} added, {known} known already, from {counted(len(paths), 'recording')}."
    )
    for words in broken:
        print(shown(f"groundstation: {words}"), file=sys.stderr)
    return EXIT_UNREADABLE if broken else 0


def flights_in(path: Path) -> Iterator[tuple[Flown, Track]]:
    """Yield the flights of a mission by somebody with a name that a recording holds and that landed.

    Raises:
        InputError: It cannot be read.
    """
    flight = Flight(path)
    mission, facts = flight.mission, flight.properties()
    device, pilot = str(facts.get("device", "")), str(facts.get("pilot", ""))
    scripted = device.startswith("scripted:") and int(facts.get("schema", 0)) <= _SCRIPTED_UP_TO
    if mission is None or not pilot or scripted:
        return
    known = Flown(
        pilot,
        mission.name,
        digest_of(mission),
        str(facts["started"]),
        seed=int(facts.get("seed", 0)),
        simulated=bool(facts.get("simulated", True)),
        device=device_word(device),
        recording=path.name,
        program=str(facts.get("groundstation", "")),
    )
    landed: list[Measurer] = attempts_of(flight, mission).landed
    for attempt, measurer in enumerate(landed, 1):
        yield judged(known, attempt, measurer, flight.par), measurer.track()
