"""Flights side by side: their numbers in columns, their ways and curves over one another."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from groundstation import __version__
from groundstation.report.document import Finding, Plate, Report, Table
from groundstation.report.figures import overlay
from groundstation.report.flight_report import Summary
from groundstation.report.flight_tables import flat
from groundstation.review.recorded_series import thinned
from groundstation.review.series import FlightSeries, lengths
from groundstation.training.mission import Mission

# More lines over one another cannot be told apart.
MOST = 6
_SHOWN = 1500
_BEST = "● "


class _Row(NamedTuple):
    """A number of every flight; NaN where one has none. `sign` is 1 where more is better, -1 where less, or 0."""

    name: str
    values: Sequence[float]
    shape: str
    sign: int


def report_on(flights: Sequence[Summary]) -> Report:
    """Return the report on two flights or more."""
    names = [chr(ord("A") + place) for place in range(len(flights))]
    coupled = [
        (name, thinned(each.series, _SHOWN)) for name, each in zip(names, flights, strict=True) if each.series
    ]
    missions = [each.flight.mission for each in flights]
    lead = ["The better of each row has a dot before it. Time counts from the moment the hand was coupled."]
    if len({mission.name if mission else "" for mission in missions}) > 1:
        lead.append(
            "These are not flights of one mission: their times and scores say little about one another."
        )
    if len(coupled) < len(flights):
        lead.append("A flight whose hand was never coupled has no curves.")
    tables = [_numbers(flights, names), *_settings(flights, names)]
    facts = [(name, str(each.flight.path)) for name, each in zip(names, flights, strict=True)]
    facts.append(("report by", f"groundstation {__version__}"))
    findings = [
        Finding(name, f"{each.flight.path.stem}: {each.outcome.result}", _points(each))
        for name, each in zip(names, flights, strict=True)
    ]
    plates = _plates(coupled, missions[0]) if coupled else ()
    return Report("Flights compared", lead, findings, plates, facts, tables)


def _points(summary: Summary) -> str:
    return f"{summary.outcome.score.points:.0f} of 100" if summary.outcome.score else "no score"


def _plates(coupled: Sequence[tuple[str, FlightSeries]], mission: Mission | None) -> Sequence[Plate]:
    return (
        Plate(
            "Ways",
            "Where they flew",
            "From above and from the side, with the first flight's obstacles.",
            overlay.WAYS_HEIGHT,
            partial(overlay.draw_ways, flights=coupled, mission=mission),
        ),
        Plate(
            "Curves",
            "How far off, how strong, how near, how fast",
            "Norms of the controller's error p̃ and of the force on the hand, clearance, and speed.",
            overlay.CURVES_HEIGHT,
            partial(overlay.draw_curves, flights=coupled),
        ),
    )


def _numbers(flights: Sequence[Summary], names: Sequence[str]) -> Table:
    rows = [
        ("flight", *(each.flight.path.stem for each in flights)),
        ("pilot", *(str(each.flight.properties().get("pilot", "")) or "not named" for each in flights)),
        ("result", *(each.outcome.result for each in flights)),
        *(_shown(row) for row in _rows(flights)),
    ]
    return Table("In numbers", "", ("", *names), rows)


def _rows(flights: Sequence[Summary]) -> Sequence[_Row]:
    figures = [each.outcome.figures for each in flights]
    series = [each.series for each in flights]

    def of(name: str) -> list[float]:
        return [float(getattr(each, name)) if each else np.nan for each in figures]

    def over(measure: str) -> list[float]:
        return [float(lengths(getattr(each, measure)).max()) if each else np.nan for each in series]

    scores = [each.outcome.score.points if each.outcome.score else np.nan for each in flights]
    return (
        _Row("score, of 100", scores, "{:.0f}", 1),
        _Row("distance to the target at the end, m", of("final_error"), "{:.3f}", -1),
        _Row("take-off to landing, s", of("duration"), "{:.1f}", -1),
        _Row("way flown, m", of("path"), "{:.1f}", -1),
        _Row("collisions", of("collisions"), "{:.0f}", -1),
        _Row("least clearance, m", of("least_clearance"), "{:.2f}", 1),
        _Row("p̃ RMS, m", of("rms_error"), "{:.3f}", -1),
        _Row("largest p̃, m", over("error"), "{:.3f}", -1),
        _Row("largest force, N", over("force"), "{:.2f}", 0),
    )


def _shown(row: _Row) -> tuple[str, ...]:
    cells = [row.shape.format(value) if np.isfinite(value) else "–" for value in row.values]
    known = [value for value in row.values if np.isfinite(value)]
    # What reads the same is the same.
    if row.sign and len({row.shape.format(value) for value in known}) > 1:
        best = row.shape.format(max(known, key=lambda value: row.sign * value))
        cells = [f"{_BEST}{cell}" if cell == best else cell for cell in cells]
    return (row.name, *cells)


def _settings(flights: Sequence[Summary], names: Sequence[str]) -> Sequence[Table]:
    tables = [flat(each.flight.settings) for each in flights]
    keys = sorted({key for table in tables for key in table})
    rows = [
        (key, *(table.get(key, "–") for table in tables))
        for key in keys
        if len({table.get(key) for table in tables}) > 1
    ]
    words = "" if rows else "All were flown with the same settings."
    return (Table("Settings that differ", words, ("setting", *names), rows),)
