"""The list of flights, for people and for programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from groundstation.review.listing import Entry, list_flights
from groundstation.review.results import Result, results_of
from groundstation.shown import shown
from groundstation.status_line import StatusLine

_HEADS = ("", "started", "length", "size", "mission", "pilot", "vehicle", "score", "result", "file")
_LONGEST = 44


def list_all(
    folder: Path, *, mission: str | None = None, pilot: str | None = None, as_json: bool = False
) -> int:
    """Print the flights in a folder, newest first; return the exit code.

    Args:
        folder: Where they are.
        mission: Only flights of this mission.
        pilot: Only this pilot's.
        as_json: For programs.
    """
    entries = list_flights(folder)
    with StatusLine(sys.stderr) as line:
        numbered = list(enumerate(results_of(entries, folder, line.step), 1))
    chosen = [
        (number, entry, result)
        for number, (entry, result) in numbered
        if mission in (None, entry.mission) and pilot in (None, result.pilot)
    ]
    if as_json:
        print(json.dumps([_fields(*each) for each in chosen], indent=1))
    elif chosen:
        print("\n".join(_lines([_HEADS, *(_row(*each) for each in chosen)])))
    else:
        print(f"No flights in {folder}{' like that' if entries else ''}.")
    return 0


def _row(number: int, entry: Entry, result: Result) -> Sequence[str]:
    words = result.result if entry.whole else f"did not end properly; {result.result}"
    return (
        f"{number}",
        entry.started.astimezone().strftime("%Y-%m-%d %H:%M:%S"),
        f"{result.duration:.1f} s",
        f"{entry.size / 1e6:.1f} MB",
        entry.mission or "–",
        result.pilot or "–",
        "sim" if result.simulated else "REAL",
        "–" if result.score is None else f"{result.score:.0f}",
        words if len(words) <= _LONGEST else f"{words[: _LONGEST - 1]}…",
        shown(entry.path.name),
    )


def _lines(rows: Sequence[Sequence[str]]) -> Iterable[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(_HEADS))]
    right = {"", "length", "size", "score"}
    for row in rows:
        cells = (
            cell.rjust(width) if head in right else cell.ljust(width)
            for cell, width, head in zip(row, widths, _HEADS, strict=True)
        )
        yield "  ".join(cells).rstrip()


def _fields(number: int, entry: Entry, result: Result) -> dict[str, object]:
    return {
        "number": number,
        "started": entry.started.isoformat(),
        "duration_s": round(result.duration, 3),
        "bytes": entry.size,
        "mission": entry.mission,
        "pilot": result.pilot,
        "simulated": result.simulated,
        "score": result.score,
        "result": result.result,
        "ended_properly": entry.whole,
        "file": str(entry.path),
    }
