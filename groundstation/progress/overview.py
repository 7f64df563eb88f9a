"""A pilot's progress as a table for people, and as an object for programs."""

from __future__ import annotations

import datetime
import textwrap
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from groundstation.progress.flown import Flown
from groundstation.progress.skills import Record, Standing
from groundstation.progress.words import counted, due_words, hours, mark, number, trend

_HEADS = ("", "mission", "level", "best", "last", "trend", "flights", "passed, due")
_WIDTH = 80
_NAME_WIDTH = 11
_BAR_WIDTH = 20


def table(pilot: str, standing: Standing, flights: Sequence[Flown], today: datetime.date) -> str:
    """Return how a pilot stands, for people."""
    following = standing.next.mission if standing.next else None
    rows: list[Sequence[str]] = [_HEADS]
    for name, record in standing.records.items():
        rows.append(
            (
                mark(record, following),
                name,
                str(record.mission.level),
                number(record.best),
                number(record.points[-1] if record.points else None),
                trend(record.points),
                _flown(record),
                ", ".join(
                    filter(None, (record.passed and record.passed.isoformat(), due_words(record, today)))
                ),
            )
        )
    lines = [summary(pilot, standing, flights)]
    if standing.next:
        words = f"Next: {standing.next.mission} ({standing.next.why})."
        lines += textwrap.wrap(words, _WIDTH, subsequent_indent=" " * len("Next: "))
    lines += ["", *aligned(rows)]
    if any(record.instructed for record in standing.records.values()):
        lines.append(
            "i: an instructor let something happen; practice, which passes no mission and has no score here"
        )
    if standing.levels:
        lines += ["", "skills", *_levels(standing)]
    return "\n".join(lines)


def _flown(record: Record) -> str:
    """Write how many flights there were, with an i for each that an instructor had a hand in."""
    return f"{record.flights or '–'}{f' ({record.instructed}i)' if record.instructed else ''}"


def summary(pilot: str, standing: Standing, flights: Sequence[Flown]) -> str:
    """Return how a pilot stands, in a sentence."""
    flown = hours(sum(each.duration_s for each in flights))
    return (
        f"{pilot or 'nobody named'}: {standing.passed} of {len(standing.records)} missions passed, "
        f"{flown} in {counted(len(flights), 'flight')}."
    )


def aligned(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Yield rows as lines with their cells in columns."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()


def _levels(standing: Standing) -> Iterator[str]:
    for skill, level in standing.levels.items():
        filled = round(level / 100.0 * _BAR_WIDTH)
        weakest = "  weakest" if skill == standing.weakest and len(standing.levels) > 1 else ""
        yield f"{skill:<{_NAME_WIDTH}} {'█' * filled}{'─' * (_BAR_WIDTH - filled)} {level:3.0f}{weakest}"


def fields(
    pilot: str, standing: Standing, flights: Sequence[Flown], today: datetime.date
) -> dict[str, object]:
    """Return how a pilot stands, for programs. What does not exist is null."""
    return {
        "pilot": pilot,
        "flights": len(flights),
        "duration_s": round(sum(each.duration_s for each in flights), 1),
        "instructed": sum(each.instructed for each in flights),
        "collisions": sum(each.collisions for each in flights),
        "passed": standing.passed,
        "next": {"mission": standing.next.mission, "why": standing.next.why} if standing.next else None,
        "weakest": standing.weakest,
        "skills": {skill: round(level, 1) for skill, level in standing.levels.items()},
        "missions": [
            {
                "mission": name,
                "level": record.mission.level,
                "open": record.open,
                "needs": list(record.missing),
                "flights": record.flights,
                "instructed": record.instructed,
                "points": [round(each, 1) for each in record.points],
                "best": None if record.best is None else round(record.best, 1),
                "passed": record.passed.isoformat() if record.passed else None,
                "due": record.repetition.due.isoformat() if record.repetition else None,
                "overdue": record.due(today),
            }
            for name, record in standing.records.items()
        ],
    }


class Career(NamedTuple):
    """What a pilot has flown, in figures: flights, time in the air (s), missions passed, and the last day."""

    flights: int
    duration_s: float
    passed: int
    last: str


def everybody(flights: Sequence[Flown]) -> dict[str, Career]:
    """Return by pilot what they have flown; flights come oldest first."""
    found: dict[str, Career] = {}
    for pilot in sorted({each.pilot for each in flights}, key=str.casefold):
        theirs = [each for each in flights if each.pilot == pilot]
        found[pilot] = Career(
            len(theirs),
            round(sum(each.duration_s for each in theirs), 1),
            len({each.mission for each in theirs if each.passed and not each.instructed}),
            theirs[-1].day.isoformat(),
        )
    return found
