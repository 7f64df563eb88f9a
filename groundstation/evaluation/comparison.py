"""Compares what was flown: who completed how much, what the figures are, and what differs.

Who is compared flew the same seeds: the same operator's noise, air, estimate and channel. So differences are taken
within a seed, and the seeds are the independent repetitions: a seed's flights under several conditions are averaged
first.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import NamedTuple

from groundstation.evaluation.case import Case, Outcome, Result
from groundstation.evaluation.intervals import Interval, mean, wilson


class Subject(NamedTuple):
    """Who is compared: controller and guard."""

    controller: str
    guard: str


class Metric(NamedTuple):
    """A figure that is compared: its name, unit, digits behind the point, and the outcome's field that has it."""

    name: str
    unit: str
    digits: int
    field: str

    def of(self, outcome: Outcome) -> float | None:
        """Return the figure, where there is one."""
        return getattr(outcome, self.field)


METRICS = (
    Metric("time", "s", 1, "time"),
    Metric("RMS error", "m", 3, "rms_error"),
    Metric("least clearance", "m", 2, "clearance"),
    Metric("collisions", "", 2, "collisions"),
    Metric("largest force", "N", 2, "max_force"),
    Metric("mean force", "N", 2, "mean_force"),
    Metric("work of the hand", "J", 3, "hand_work"),
    Metric("energy dissipated", "J", 3, "dissipated"),
    Metric("input disagreement", "m/s", 3, "disagreement"),
)
# The columns by which flights are told apart, besides who is compared and the seed.
CONDITIONS = ("mission", "delay", "jitter", "loss", "wind", "operator", "rate", "airframe", "model")

Flights = dict[tuple[Hashable, ...], Outcome]


def subjects(results: Iterable[Result]) -> dict[Subject, Flights]:
    """Return each subject's outcomes by condition and seed, in the order in which they were asked for."""
    found: dict[Subject, Flights] = {}
    for result in results:
        found.setdefault(subject_of(result.case), {})[condition(result.case)] = result.outcome
    return found


def subject_of(case: Case) -> Subject:
    """Return who flew."""
    return Subject(case.controller, case.guard)


def condition(case: Case) -> tuple[Hashable, ...]:
    """Return under what it was flown; the seed comes last."""
    return (*(getattr(case, name) for name in CONDITIONS), case.seed)


def completed(flights: Flights) -> Interval:
    """Return the rate of completed flights."""
    return wilson(sum(outcome.completed for outcome in flights.values()), len(flights))


def average(flights: Flights, metric: Metric) -> Interval:
    """Return a figure's mean over the seeds, over the flights that have it."""
    return _over_seeds((key, metric.of(outcome)) for key, outcome in flights.items())


def difference(flights: Flights, base: Flights, metric: Metric) -> Interval:
    """Return how much more the figure is than the base's, over pairs of the same condition and seed."""
    pairs = (
        (key, metric.of(outcome), metric.of(base[key])) for key, outcome in flights.items() if key in base
    )
    return _over_seeds((key, None if a is None or b is None else a - b) for key, a, b in pairs)


def discordant(flights: Flights, base: Flights) -> tuple[int, int]:
    """Return how many pairs only the base completed, and how many only the other."""
    pairs = [(outcome.completed, base[key].completed) for key, outcome in flights.items() if key in base]
    return sum(there and not here for here, there in pairs), sum(here and not there for here, there in pairs)


def _over_seeds(figures: Iterable[tuple[tuple[Hashable, ...], float | None]]) -> Interval:
    seeds: dict[Hashable, list[float]] = {}
    for key, figure in figures:
        if figure is not None:
            seeds.setdefault(key[-1], []).append(figure)
    return mean([sum(values) / len(values) for values in seeds.values()])
