"""The report on one recorded flight: verdict, figures 9 to 13 of the paper for it, and what stands around them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from groundstation import __version__
from groundstation.recording import lanes, schema
from groundstation.report import flight_tables as tables
from groundstation.report.document import Finding, Plate, Report, Table
from groundstation.report.figures import cues, energy, errors, force, lateness, motion, timeline, velocities
from groundstation.report.paper_findings import following
from groundstation.review.flight import Flight
from groundstation.review.outcome import Outcome, outcome_of, radius_of
from groundstation.review.recorded_series import recorded_series, thinned
from groundstation.review.series import FlightSeries, lengths
from groundstation.review.sights import origin
from groundstation.training.mission import Mission

# More samples a page's width does not show, and a mail does not like.
_SHOWN = 1200
_LANES = (lanes.MODE, lanes.PHASE, lanes.STAGE, lanes.GUARD, lanes.MAPPING, lanes.PRESET, lanes.INTERVENTION)


class Summary(NamedTuple):
    """A flight that was read, with what it came to.

    Attributes:
        flight: The recording.
        outcome: Of the mission.
        series: Its coupled part; None where the hand was never coupled.
    """

    flight: Flight
    outcome: Outcome
    series: FlightSeries | None


def summarised(flight: Flight) -> Summary:
    """Return a flight with what it came to.

    Raises:
        InputError: It was recorded by a later version of this program.
    """
    return Summary(flight, outcome_of(flight), recorded_series(flight))


def report_on(summary: Summary) -> Report:
    """Return the report on a flight."""
    flight, outcome, series = summary
    facts = flight.properties()
    mission = flight.mission
    shown = thinned(series, _SHOWN) if series else None
    title = f"{mission.title if mission else 'Free flight'}: {outcome.result}"
    plates = [*_figures(shown, mission), *_around(flight)]
    return Report(
        title, _lead(summary, facts), findings(summary), plates, _facts(flight, facts), _tables(summary)
    )


def findings(summary: Summary) -> list[Finding]:
    """Return the key numbers, with the mission's bars where it has any."""
    flight, outcome, series = summary
    found: list[Finding] = []
    if outcome.score is not None:
        found.append(Finding("", "score, of 100", f"{outcome.score.points:.0f}"))
    if outcome.figures and outcome.completed is not None and flight.mission:
        found += _judged(outcome, flight.mission)
    if series:
        found += [
            Finding("Fig. 11", "largest force on the hand", f"{lengths(series.force).max():.2f} N"),
            Finding("Fig. 12", "controller's error p̃, RMS", f"{_rms(lengths(series.error)):.3f} m"),
            Finding("Fig. 13", "velocity executed late by", f"{following(series).lag:.2f} s"),
            Finding("", "hand coupled for", f"{series.t[-1]:.1f} s"),
        ]
    return [*found, Finding("", "recorded", f"{flight.duration:.1f} s")]


def _judged(outcome: Outcome, mission: Mission) -> Iterator[Finding]:
    figures, criteria = outcome.figures, mission.criteria
    assert figures is not None
    reached = not np.isnan(figures.final_error)
    words = f"{figures.final_error:.3f} m" if reached else "not held"
    yield Finding(
        "Fig. 12",
        "distance to the target, at the end of the hold",
        words,
        f"≤ {criteria.final_error_m:g} m",
        reached and figures.final_error <= criteria.final_error_m,
    )
    yield Finding(
        "",
        "collisions",
        f"{figures.collisions}",
        f"≤ {criteria.max_collisions}",
        figures.collisions <= criteria.max_collisions,
    )
    yield Finding(
        "",
        "from take-off to landing",
        f"{figures.duration:.1f} s",
        f"≤ {criteria.time_limit_s:g} s",
        figures.duration <= criteria.time_limit_s,
    )
    if np.isfinite(figures.least_clearance):
        yield Finding("Fig. 9", "least clearance", f"{figures.least_clearance:.2f} m")
    yield Finding("Fig. 9", "way flown", f"{figures.path:.1f} m")


def _lead(summary: Summary, facts: dict[str, object]) -> list[str]:
    flight, outcome, series = summary
    who = str(facts.get("pilot", "")) or "a pilot who is not named"
    what = "the simulated vehicle" if facts.get("simulated") else "a vehicle"
    lines = [
        f"Flown by {who} with {what}, {str(facts.get('started', 'at an unknown time'))[:19].replace('T', ' ')}."
    ]
    if outcome.shortcomings:
        lines.append("What the mission asks for and did not get: " + "; ".join(outcome.shortcomings) + ".")
    if series is None:
        lines.append("The hand was never coupled to the vehicle, so there are no figures of the flight.")
    if flight.mission is None:
        lines.append("No mission was flown, so nothing is judged.")
    return lines


def _figures(series: FlightSeries | None, mission: Mission | None) -> Iterator[Plate]:
    """Yield the paper's figures for this flight."""
    if series is None:
        return
    if mission is not None:
        yield Plate(
            "Figure 9",
            "The way flown",
            "In perspective, from the side and from above. Circles are the hull at equal times: where they crowd, "
            "the drone is slow.",
            motion.HEIGHT,
            partial(motion.draw, series=series, mission=mission, radius=radius_of(mission)),
        )
    yield Plate(
        "Figure 11",
        "The force on the hand",
        "Strong lines: equation (5), f = −K p̃; thin lines: what the hand felt. Shaded: an obstacle was near.",
        force.HEIGHT,
        partial(force.draw, series=series),
    )
    if cues.felt(series):
        yield Plate(
            "Cues",
            "What the force is made of",
            "Cues that nobody could feel are left out.",
            cues.HEIGHT,
            partial(cues.draw, series=series),
        )
    if mission is not None and mission.target is not None:
        bar = mission.criteria.final_error_m
        yield Plate(
            "Figure 12",
            "The errors",
            "Above, from the vehicle to the target by axis; below as a distance, with the controller's own error p̃.",
            errors.HEIGHT,
            partial(errors.draw, series=series, target=mission.target, bar=bar),
        )
    yield Plate(
        "Figure 13",
        "Reference and executed velocity",
        "v_ref of equation (4) on the drone's own axes, and what it flew.",
        velocities.HEIGHT,
        partial(velocities.draw, series=series),
    )


def _around(flight: Flight) -> Iterator[Plate]:
    """Yield what stands around the paper's figures."""
    if delays := tables.delays_of(flight):
        yield Plate(
            "Delay",
            "How late everything was",
            "The largest of each moment, on a scale of powers of ten.",
            lateness.HEIGHT,
            partial(lateness.draw, delays=delays),
        )
    account = flight.series(schema.HANDLE_ENERGY)
    if len(account.t):
        yield Plate(
            "Passivity",
            "The hand's account, and what was taken out of the force to keep it",
            "Energy that the hand has given and not been given back. Below zero it lives on a credit of 0.9 mJ.",
            energy.HEIGHT,
            partial(energy.draw, energy=account),
        )
    states = [(lane, changes) for lane in _LANES if (changes := flight.states(lane))]
    yield Plate(
        "Timeline",
        "What happened when",
        "Bars are states; marks are the operator's acts, warnings (triangles) and alarms (crosses).",
        timeline.HEIGHT,
        partial(timeline.draw, states=states, events=flight.events(), end=flight.duration),
    )


def _tables(summary: Summary) -> list[Table]:
    flight, outcome, _ = summary
    score = tables.score(outcome, str(flight.properties().get("par_from", "")))
    found = [
        score,
        tables.lost(outcome, origin(flight)),
        tables.lateness(tables.delays_of(flight)),
        tables.servo(flight),
    ]
    found += [tables.passivity(flight), tables.events(flight), *tables.settings(flight.settings)]
    return [table for table in found if table is not None and (table.rows or table.words)]


def _facts(flight: Flight, facts: dict[str, object]) -> list[tuple[str, str]]:
    device = flight.properties(schema.DEVICE)
    names = (
        "pilot",
        "mission",
        "seed",
        "vehicle",
        "device",
        "controller",
        "groundstation",
        "revision",
        "machine",
    )
    found = [(name, str(facts[name])) for name in names if facts.get(name) not in (None, "")]
    if device:
        found.append(("device found", f"{device.get('name', '')} {device.get('serial', '')}".strip()))
    return [*found, ("recording", flight.path.name), ("report by", f"groundstation {__version__}")]


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.square(values).mean()))
