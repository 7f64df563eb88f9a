"""How fast `groundstation evaluate` flies: the paper's mission, dynamic model, everything on, on a lossy link.

What one core does is counted in processor time, as virtual seconds a second; the cost of a tick is beside it. How it
grows with the cores is counted by the wall clock, from the first flight that ends to the last.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Iterator

import msgspec

from groundstation.config import Settings
from groundstation.evaluation.case import Case, Task
from groundstation.evaluation.trial import fly
from groundstation.evaluation.work import fly_here
from groundstation.training.mission import find_mission, load_mission

BARS = {1000.0: 10.0, 250.0: 40.0}
BAR_LINEAR = 0.9


def task(rate: float, seed: int, preset: str = "assisted") -> Task:
    """Return a flight of the paper's mission."""
    mission = load_mission(find_mission("paper"))
    vehicle = mission.vehicle
    settings = Settings()
    settings = msgspec.structs.replace(
        settings, control=msgspec.structs.replace(settings.control, preset=preset)
    )
    case = Case(
        controller=preset,
        guard=settings.shield.guard,
        mission=mission.name,
        delay=0.1,
        jitter=0.01,
        loss=0.02,
        wind="mission",
        operator="average",
        seed=seed,
        rate=rate,
        airframe=vehicle.airframe,
        model=vehicle.model,
    )
    return Task(case, mission, settings)


def one_core(rate: float, flights: int) -> list[float]:
    """Return the virtual seconds a second of processor time of each flight."""
    outcomes = [fly(task(rate, seed)).outcome for seed in range(flights)]
    return [outcome.flown / outcome.processor for outcome in outcomes]


def together(jobs: int, flights: int) -> float:
    """Return the virtual seconds a second of the wall clock that so many processes fly."""
    began, flown = 0.0, 0.0
    for result in fly_here(fly, [task(250.0, seed) for seed in range(flights)], jobs):
        if began:
            flown += result.outcome.flown
        else:
            began = time.perf_counter()
    return flown / (time.perf_counter() - began)


def main(*, short: bool) -> Iterator[str]:
    """Yield the lines of the table."""
    for rate, bar in BARS.items():
        found = one_core(rate, 2 if short else 10)
        pace = statistics.median(found)
        yield (
            f"servo at {rate:4.0f} Hz: {pace:5.1f} x real time on a core (bar {bar:.0f}), "
            f"from {min(found):.1f} to {max(found):.1f}, {1e6 / (rate * pace):.0f} us a tick"
        )
    flights, cores = (12, 2) if short else (60, os.cpu_count() or 1)
    alone, all_together = together(1, flights // cores), together(cores, flights)
    yield (
        f"250 Hz, {cores} processes: {all_together:.1f} x real time, one: {alone:.1f}; "
        f"{all_together / alone / cores:.2f} of linear (bar {BAR_LINEAR})"
    )
