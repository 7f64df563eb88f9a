"""Whether every mission that comes with the program can be flown and must be: simulated operators on several seeds.

The expert passes on each seed, a hand that does nothing fails on each, and novice, average and expert score in that
order in the mean over the seeds.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from statistics import fmean

from groundstation.evaluation.work import fly_here, processes
from groundstation.operators.exercise import NOBODY, Exercise, Flown, fly
from groundstation.operators.standing import Standing, standing_of
from groundstation.operators.table import table
from groundstation.training.mission import MISSIONS_FOLDER, SUFFIX, Mission, load_mission
from sim.people import PEOPLE

SEEDS, SHORT_SEEDS = 5, 1
BAR_ORDERED = 0.9


def missions() -> list[Mission]:
    """Return what comes with the program and asks for something."""
    found = [load_mission(path) for path in sorted(MISSIONS_FOLDER.glob(f"*{SUFFIX}"))]
    return [mission for mission in found if mission.judged]


def stand(asked: Sequence[Mission], seeds: int) -> list[Standing]:
    """Fly each mission with everybody on so many seeds."""
    exercises = [
        Exercise(mission, name, seed)
        for mission in asked
        for name in (*PEOPLE, NOBODY)
        for seed in range(seeds)
    ]
    flown: dict[str, list[Flown]] = {mission.name: [] for mission in asked}
    for name, result in fly_here(_fly, exercises, processes(None, len(exercises))):
        flown[name].append(result)
    return [standing_of(mission, flown[mission.name]) for mission in asked]


def _fly(exercise: Exercise) -> tuple[str, Flown]:
    return exercise.mission.name, fly(exercise)


def passed(standing: Standing, operator: str) -> int:
    """Return how many flights of an operator passed."""
    return sum(not each.lacks for each in standing.of(operator))


def ordered(standing: Standing) -> bool:
    """Say whether the operators score in the order of their skill."""
    novice, average, expert = (fmean(each.points for each in standing.of(name)) for name in PEOPLE)
    return novice < average < expert


def main(*, short: bool) -> Iterator[str]:
    """Yield the lines of the table, and what the bars ask for."""
    asked, seeds = missions(), SHORT_SEEDS if short else SEEDS
    began = time.perf_counter()
    standings = stand(asked, seeds)
    took = time.perf_counter() - began
    yield from table(standings).splitlines()
    flights = len(asked) * seeds
    yield f"expert passes {sum(passed(each, 'expert') for each in standings)} of {flights} flights (bar: all)"
    yield f"doing nothing passes {sum(passed(each, NOBODY) for each in standings)} of {flights} (bar: none)"
    in_order = sum(map(ordered, standings))
    yield f"novice < average < expert in {in_order} of {len(asked)} missions (bar: {BAR_ORDERED:.0%})"
    virtual = sum(each.flown.flown for standing in standings for each in standing.marked)
    yield f"{len(asked) * seeds * (len(PEOPLE) + 1)} flights, {virtual / took:.0f} x real time on all cores"
