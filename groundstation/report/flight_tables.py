"""What a flight's report tells in tables: lateness, servo, passivity, score, events, settings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import msgspec
import numpy as np

from groundstation.config import Settings
from groundstation.recording import schema
from groundstation.report.document import Table
from groundstation.review.flight import Flight, Numbers, Series
from groundstation.review.outcome import Outcome
from groundstation.training.score import NO_PAR, measure
from groundstation.training.story import worth_telling

DELAYS = {
    "vehicle's state (d₁)": schema.STATE_AGE,
    "handle to setpoint": schema.HANDLE_AGE,
    "round trip": schema.ROUND_TRIP,
    "silence of the link": schema.SILENCE,
}
_SHARES = (50, 90, 99, 100)
_LEVELS = {"INFO": "", "WARN": "! warning", "ERROR": "!! ALARM"}


def delays_of(flight: Flight) -> Mapping[str, Series]:
    """Return the delays that were recorded, by name."""
    found = {name: flight.series(quantity) for name, quantity in DELAYS.items()}
    return {name: series for name, series in found.items() if np.isfinite(series.values).any()}


def lateness(delays: Mapping[str, Series]) -> Table:
    """Return percentiles of the delays, ms."""
    rows = [(name, *_percentiles(series.values[:, 0] * 1e3)) for name, series in delays.items()]
    words = "In ms. The state's age counts from its arrival, the handle's from the sample to the setpoint it became."
    return Table("How late", words, ("", "p50", "p90", "p99", "largest"), rows)


def servo(flight: Flight) -> Table:
    """Return how well the servo kept its time."""
    rate, late = flight.series(schema.SERVO_RATE).values, flight.series(schema.SERVO_LATE).values
    times, ticks = flight.series(schema.SERVO_TIME).values, flight.series(schema.SERVO_TICKS).values
    rows: list[tuple[str, str]] = []
    if len(rate):
        run, missed = ticks[-1]
        share = 100.0 * run / max(run + missed, 1.0)
        rows = [
            ("rate", f"{np.median(rate[:, 0]):.0f} Hz"),
            ("ticks run", f"{run:.0f}, {share:.2f} % of those due"),
            ("lateness, p50 of the usual half second", f"{np.median(late[:, 0]) * 1e6:.0f} µs"),
            ("lateness, p99 of the usual half second", f"{np.median(late[:, 1]) * 1e6:.0f} µs"),
            ("lateness, largest", f"{late[:, 2].max() * 1e6:.0f} µs"),
            ("longest read of the device", f"{times[:, 0].max() * 1e6:.0f} µs"),
            ("longest write to the device", f"{times[:, 1].max() * 1e6:.0f} µs"),
            ("longest step of the pilot", f"{times[:, 2].max() * 1e6:.0f} µs"),
        ]
    return Table("The servo", "", ("", ""), rows)


def passivity(flight: Flight) -> Table:
    """Return the ledger of the haptic port, worked out anew from force and motion of the handle."""
    energy = flight.series(schema.HANDLE_ENERGY)
    given, returned = _port_work(flight)
    rows: list[tuple[str, str]] = [
        ("given by the hand", f"{given * 1e3:.1f} mJ"),
        ("given back to the hand", f"{returned * 1e3:.1f} mJ"),
        ("balance", f"{(given - returned) * 1e3:.1f} mJ"),
    ]
    if len(energy.t):
        rows.append(("lowest account", f"{np.nanmin(energy.values[:, 0]) * 1e3:.2f} mJ"))
        rows.append(("taken out of the force", f"{energy.values[-1, 1] * 1e3:.1f} mJ"))
    words = (
        "The port gives the hand no more than it got, but for a credit of 0.9 mJ. Recomputed here as Σ f·Δx."
    )
    return Table("Passivity", words, ("", ""), rows)


def score(outcome: Outcome, par_from: str) -> Table | None:
    """Return the score part by part; None where there is none.

    Args:
        outcome: Of the flight.
        par_from: Whose flight it is held against, in words, or "".
    """
    if outcome.score is None:
        return None
    rows = [
        (
            part.name,
            f"{part.points:.1f} of {part.weight:.1f}",
            measure(part.value, part.unit),
            measure(part.par, part.unit) if np.isfinite(part.par) else "–",
            part.formula,
        )
        for part in outcome.score.parts
    ]
    rows.append(("score", f"{outcome.score.points:.1f} of 100", "", "", "the sum"))
    return Table(
        "Score",
        f"Held against {par_from or NO_PAR}.",
        ("part", "points", "reached", "par", "how it comes about"),
        rows,
    )


def lost(outcome: Outcome, start: float) -> Table | None:
    """Return where points were lost, what cost most first; None where there is no score.

    Args:
        outcome: Of the flight.
        start: When the recording begins on the clock of the flight, s.
    """
    if outcome.judgement is None or outcome.score is None:
        return None
    rows = [
        (f"{moment.t - start:.1f} s", f"−{moment.lost:.1f}", moment.part, moment.words)
        for moment in worth_telling(outcome.judgement.story)
    ]
    words = "" if rows else "Nowhere."
    return Table("Where points were lost", words, ("time", "points", "part", "what happened"), rows)


def events(flight: Flight) -> Table:
    """Return all events, commands and answers."""
    rows = [
        (f"{line.t:.2f} s", _LEVELS.get(line.level, line.level), line.source, line.text)
        for line in flight.events()
    ]
    return Table("What happened", "", ("time", "", "from", "words"), rows)


def settings(flown: Settings) -> Iterator[Table]:
    """Yield the settings that differ from the defaults, then all of them."""
    changed, everything = flat(flown), flat(Settings())
    other = [
        (key, value, everything.get(key, ""))
        for key, value in changed.items()
        if value != everything.get(key)
    ]
    words = "" if other else "All settings are the defaults."
    yield Table("Settings that differ", words, ("setting", "flown with", "default"), other)
    yield Table("All settings", "", ("setting", "flown with"), list(changed.items()), folded=True)


def flat(flown: Settings) -> dict[str, str]:
    """Return settings as words by `table.key`."""
    return {
        f"{table}.{key}": str(value)
        for table, entries in msgspec.to_builtins(flown).items()
        for key, value in entries.items()
    }


def _percentiles(values: Numbers) -> tuple[str, ...]:
    known = values[np.isfinite(values)]
    # An age of less than nothing is the clock's rounding.
    return tuple(f"{abs(value):.1f}" for value in np.percentile(known, _SHARES))


def _port_work(flight: Flight) -> tuple[float, float]:
    """Return what the hand gave, and was given back, J, from the force held between two samples of the handle."""
    position, force = (
        flight.series(schema.HANDLE_POSITION).values[:, :3],
        flight.series(schema.HANDLE_FORCE).values,
    )
    if len(position) < 2 or len(force) != len(position):
        return 0.0, 0.0
    work = (force[:-1] * np.diff(position, axis=0)).sum(axis=1)
    return float(-work[work < 0.0].sum()), float(work[work > 0.0].sum())
