"""A class's worth of flights: how every pilot is doing, and who needs help."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from groundstation import __version__
from groundstation.progress import flown as progress_flown
from groundstation.progress.skills import Standing
from groundstation.report.document import Finding, Plate, Report, Table
from groundstation.report.figures import progress
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of

# A pilot whose last scores are in the mean below this needs help; so does one who collides in half of the flights.
_LOW = 50.0
_LAST = 3


class Flown(NamedTuple):
    """A flight as a class's report needs it.

    Attributes:
        pilot, mission, started: As recorded; the start as ISO 8601.
        completed: None where there is nothing to be completed.
        score: 0 to 100; NaN without one.
        collisions: With obstacles.
        result: In words.
        file: The recording's name.
    """

    pilot: str
    mission: str
    started: str
    completed: bool | None
    score: float
    collisions: int
    result: str
    file: str


def flown(flight: Flight) -> Flown:
    """Return what a class's report needs of a flight.

    Raises:
        InputError: It was recorded by a later version of this program.
    """
    facts, outcome = flight.properties(), outcome_of(flight)
    return Flown(
        str(facts.get("pilot", "")) or "not named",
        str(facts.get("mission", "")),
        str(facts.get("started", "")),
        outcome.completed,
        outcome.score.points if outcome.score else np.nan,
        outcome.figures.collisions if outcome.figures else 0,
        outcome.result,
        flight.path.name,
    )


def kept(flight: progress_flown.Flown) -> Flown:
    """Return what a class's report needs of a flight in the store of progress."""
    points = np.nan if flight.points is None else flight.points
    result = {True: "passed", False: "not passed", None: "landed"}[flight.passed]
    return Flown(
        flight.pilot,
        flight.mission,
        flight.started,
        flight.passed,
        points,
        flight.collisions,
        result,
        flight.recording,
    )


def report_on(
    flights: Iterable[Flown], broken: Sequence[str], standings: Mapping[str, Standing] | None = None
) -> Report:
    """Return the report on a class.

    Args:
        flights: In any order.
        broken: What was said of recordings that could not be read.
        standings: By pilot, where they come from the store of progress.
    """
    ordered = sorted(flights, key=lambda each: each.started)
    pilots = {
        name: [each for each in ordered if each.pilot == name] for name in sorted({e.pilot for e in ordered})
    }
    needing = [name for name, theirs in pilots.items() if _needs_help(theirs)]
    findings = [
        Finding("", "flights", f"{len(ordered)}"),
        Finding("", "pilots", f"{len(pilots)}"),
        Finding("", "completed", f"{sum(each.completed is True for each in ordered)}"),
        Finding("", "pilots that need help", ", ".join(needing) or "none"),
    ]
    lead = [
        f"{len(ordered)} flights of {len(pilots)} pilots, {ordered[0].started[:10]} to {ordered[-1].started[:10]}."
    ]
    tables = [_pilots(pilots, needing), *_school(standings or {}), _missions(ordered), _flights(ordered)]
    if broken:
        tables.append(
            Table("Recordings that could not be read", "", ("what is wrong",), [(words,) for words in broken])
        )
    scores = {
        name: [each.score for each in theirs if np.isfinite(each.score)] for name, theirs in pilots.items()
    }
    plates = ()
    if any(scores.values()):
        plates = (
            Plate(
                "Progress",
                "Every pilot's scores, flight by flight",
                f"Dashed: {_LOW:g}, below which a pilot's last flights call for help.",
                progress.height(len(pilots)),
                partial(progress.draw, scores=scores, low=_LOW),
            ),
        )
    return Report(
        "The class", lead, findings, plates, [("report by", f"groundstation {__version__}")], tables
    )


def _needs_help(theirs: Sequence[Flown]) -> bool:
    scores = [each.score for each in theirs if np.isfinite(each.score)][-_LAST:]
    collided = sum(each.collisions > 0 for each in theirs)
    return bool(scores and np.mean(scores) < _LOW) or 2 * collided >= len(theirs) > 0


def _pilots(pilots: dict[str, list[Flown]], needing: Sequence[str]) -> Table:
    rows: list[tuple[str, ...]] = []
    for name, theirs in pilots.items():
        scores = [each.score for each in theirs if np.isfinite(each.score)]
        best, last, mean = (max(scores), scores[-1], float(np.mean(scores))) if scores else (np.nan,) * 3
        done = sum(each.completed is True for each in theirs)
        collisions = sum(each.collisions for each in theirs)
        help_words = "needs help" if name in needing else ""
        rows.append(
            (
                name,
                f"{len(theirs)}",
                f"{done}",
                _number(mean),
                _number(best),
                _number(last),
                f"{collisions}",
                help_words,
            )
        )
    heads = ("pilot", "flights", "completed", "mean", "best", "last", "collisions", "")
    return Table("Pilots", "Scores of 100.", heads, rows)


def _school(standings: Mapping[str, Standing]) -> Iterator[Table]:
    """Yield what each pilot can do, and what each needs: most help where a level is lowest."""
    if not standings:
        return
    skills = sorted({skill for standing in standings.values() for skill in standing.levels})
    yield Table(
        "Skills",
        f"How the latest flights of each skill went, of 100; ▲ under {_LOW:g}.",
        ("pilot", *skills),
        [
            (name, *(_level(standing.levels.get(skill)) for skill in skills))
            for name, standing in standings.items()
        ],
    )
    yield Table(
        "School",
        "What comes next is what the school recommends.",
        ("pilot", "passed", "weakest", "next", "why"),
        [
            (
                name,
                f"{standing.passed} of {len(standing.records)}",
                standing.weakest or "–",
                standing.next.mission if standing.next else "–",
                standing.next.why if standing.next else "",
            )
            for name, standing in standings.items()
        ],
    )


def _level(level: float | None) -> str:
    return "–" if level is None else f"{'▲ ' if level < _LOW else ''}{level:.0f}"


def _missions(flights: Sequence[Flown]) -> Table:
    rows: list[tuple[str, ...]] = []
    for name in sorted({each.mission for each in flights}):
        of_it = [each for each in flights if each.mission == name]
        scores = [each.score for each in of_it if np.isfinite(each.score)]
        done = sum(each.completed is True for each in of_it)
        rows.append(
            (
                name or "none",
                f"{len(of_it)}",
                f"{done}",
                _number(float(np.mean(scores)) if scores else np.nan),
            )
        )
    return Table("Missions", "", ("mission", "flights", "completed", "mean score"), rows)


def _flights(flights: Sequence[Flown]) -> Table:
    rows = [
        (
            each.started[:16].replace("T", " "),
            each.pilot,
            each.mission,
            _number(each.score),
            each.result,
            each.file,
        )
        for each in flights
    ]
    return Table(
        "All flights", "", ("started", "pilot", "mission", "score", "result", "recording"), rows, folded=True
    )


def _number(value: float) -> str:
    return f"{value:.0f}" if np.isfinite(value) else "–"
