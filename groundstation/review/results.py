"""What the flights in a folder came to. Reading a flight takes a while, so it is kept beside the recordings."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from groundstation import __version__
from groundstation.errors import InputError
from groundstation.recording.parts import parts_of
from groundstation.review.listing import Entry

# Safe to delete: it is made anew.
CACHE = ".flights.json"
# What was kept by other rules of scoring is read anew.
_RULES = f"{__version__}, scoring 2"


class Result(Struct, frozen=True):
    """What a flight came to.

    Attributes:
        pilot: Who flew; "" where it was not recorded.
        simulated: The vehicle was.
        result: In words.
        score: 0 to 100; None without one.
        duration: s.
    """

    pilot: str = ""
    simulated: bool = True
    result: str = ""
    score: float | None = None
    duration: float = 0.0


class _Kept(Struct):
    """By file: size and time of change when it was read, by which version, and what it came to."""

    size: int
    changed_ns: int
    version: str
    result: Result


def results_of(
    entries: Sequence[Entry], folder: Path, tell: Callable[[str], None] = lambda _words: None
) -> Iterator[tuple[Entry, Result]]:
    """Yield what each flight came to; those not read before are read now.

    Args:
        entries: Flights of the folder.
        folder: Where they are, and where the results are kept.
        tell: Told what is being read.
    """
    kept, new = _load(folder / CACHE), False
    for entry in entries:
        changed_ns = max(part.stat().st_mtime_ns for part in parts_of(entry.path))
        known = kept.get(entry.path.name)
        if known is None or (known.size, known.changed_ns, known.version) != (
            entry.size,
            changed_ns,
            _RULES,
        ):
            tell(f"reading {entry.path.name}")
            known = _Kept(entry.size, changed_ns, _RULES, _read(entry.path))
            kept[entry.path.name] = known
            new = True
        yield entry, known.result
    if new:
        # A folder that cannot be written is read again the next time.
        with contextlib.suppress(OSError):
            (folder / CACHE).write_bytes(msgspec.json.encode(kept))


def _load(path: Path) -> dict[str, _Kept]:
    try:
        return msgspec.json.decode(path.read_bytes(), type=dict[str, _Kept])
    except (OSError, msgspec.DecodeError):
        return {}


def _read(path: Path) -> Result:
    from groundstation.review.flight import Flight
    from groundstation.review.outcome import outcome_of

    try:
        flight = Flight(path)
        facts = flight.properties()
        if "schema" not in facts:
            return Result(result="is no flight of this program")
        outcome = outcome_of(flight)
    except InputError as error:
        return Result(result=f"cannot be read: {error}")
    score = round(outcome.score.points, 1) if outcome.score else None
    simulated = bool(facts.get("simulated", True))
    return Result(str(facts.get("pilot", "")), simulated, outcome.result, score, flight.duration)
