"""`groundstation missions measure`: simulated operators fly missions, so that each one's par is known."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from groundstation.errors import InputError
from groundstation.evaluation.progress import Progress
from groundstation.evaluation.trial import scenario_of
from groundstation.evaluation.work import WorkError, fly_here, processes
from groundstation.operators.exercise import NOBODY, Exercise, Flown, fly
from groundstation.operators.standing import Standing, standing_of
from groundstation.operators.table import table
from groundstation.training.mission import MISSIONS_FOLDER, SUFFIX, Mission, find_mission, load_mission
from groundstation.training.reference import save_reference
from sim.people import PEOPLE
from sim.scenario import ScenarioError
from sim.simulator import build

EXIT_FAILED, EXIT_STOPPED = 1, 130
_MOST_SEEDS = 1000


class Asked(NamedTuple):
    """A mission that is to be measured: its file, and what it holds."""

    path: Path
    mission: Mission


class Flight(NamedTuple):
    """An exercise of one of the missions asked for, by its number; it is what a process is given."""

    number: int
    exercise: Exercise


def run(asked: argparse.Namespace) -> int:
    """Measure what was asked for and return the exit code.

    Raises:
        InputError: A mission or an option cannot be used.
    """
    if not 1 <= asked.seeds <= _MOST_SEEDS:
        raise InputError(f"--seeds {asked.seeds}: is not a number of seeds from 1 to {_MOST_SEEDS}.")
    missions = _missions(asked)
    flights = [
        Flight(number, exercise)
        for number, (_, mission) in enumerate(missions)
        for exercise in exercises(mission, asked.seeds)
    ]
    jobs = processes(asked.jobs, len(flights))
    standings: list[Standing] = []
    why, code = "", 0
    try:
        with Progress(len(flights), 0, sys.stderr) as progress:
            standings.extend(_standings(missions, flights, jobs, progress))
    except KeyboardInterrupt:
        why, code = "stopped", EXIT_STOPPED
    except WorkError as error:
        why, code = str(error), EXIT_FAILED
    if standings:
        print(table(standings))
    if why:
        print(f"{why}: {len(standings)} of {len(missions)} missions are measured.", file=sys.stderr)
    return code or (EXIT_FAILED if any(standing.fault for standing in standings) else 0)


def exercises(mission: Mission, seeds: int) -> list[Exercise]:
    """Return the flights a mission is measured by: every person on every seed, and once a hand that does nothing."""
    flown = [Exercise(mission, name, seed) for name in PEOPLE for seed in range(seeds)]
    return [*flown, Exercise(mission, NOBODY, 0)]


def _fly(flight: Flight) -> tuple[int, Flown]:
    return flight.number, fly(flight.exercise)


def _standings(
    missions: Sequence[Asked], flights: Sequence[Flight], jobs: int, progress: Progress
) -> Iterator[Standing]:
    """Fly, and yield each mission once all its flights are flown and its par is written."""
    flown: list[list[Flown]] = [[] for _ in missions]
    expected = len(flights) // len(missions)
    with closing(fly_here(_fly, flights, jobs)) as results:
        for number, result in results:
            progress.add(result.flown)
            flown[number].append(result)
            if len(flown[number]) == expected:
                yield _keep(*missions[number], flown[number])


def _keep(path: Path, mission: Mission, flown: Sequence[Flown]) -> Standing:
    """Write the par, where the mission is one that can be flown and must be."""
    standing = standing_of(mission, flown)
    if not standing.fault:
        try:
            save_reference(standing.reference, path)
        except OSError as error:
            raise InputError(
                f"{error.filename}: cannot be written ({error.strerror}); copy the mission to a folder of yours."
            ) from error
    return standing


def _missions(asked: argparse.Namespace) -> list[Asked]:
    """Read what is to be measured."""
    if asked.all == bool(asked.missions):
        raise InputError("Give missions by name or file, or --all for those that come with the program.")
    paths = (
        sorted(MISSIONS_FOLDER.glob(f"*{SUFFIX}"))
        if asked.all
        else [find_mission(name) for name in asked.missions]
    )
    found = [Asked(path, load_mission(path)) for path in paths]
    for path, mission in found:
        try:
            build(scenario_of(mission, mission.wind))
        except ScenarioError as error:
            raise InputError(f"{path}: {error}") from error
        if not mission.judged and not asked.all:
            raise InputError(f"{path}: has no route, target or landing, so there is nothing to measure.")
    return [each for each in found if each.mission.judged]
