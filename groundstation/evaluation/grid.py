"""From the axes of the command line to the tasks of an evaluation."""

from __future__ import annotations

import importlib.util
import itertools
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

import msgspec

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.evaluation.axes import Axes
from groundstation.evaluation.case import Case, Task
from groundstation.evaluation.trial import PRESET_NAMES, scenario_of
from groundstation.messages import Preset
from groundstation.pilot.guest import load_controller
from groundstation.pilot.presets import PRESETS
from groundstation.training.mission import Mission, find_mission, load_mission
from sim.scenario import ScenarioError
from sim.simulator import build

OFF = "off"


def tasks(axes: Axes, settings: Settings) -> list[Task]:
    """Return all that is to be flown: seed by seed, and what is compared one after the other.

    Raises:
        InputError: A mission, airframe or controller cannot be flown; in one sentence, before anything is.
    """
    missions = _missions(axes)
    sources = {spec: _source(spec, settings) for spec in axes.controllers}
    # A preset without a guard is the same flight whatever the guard would be.
    cases = dict.fromkeys(_cases(axes, missions, axes.guards or (settings.shield.guard,)))
    return [
        Task(case, missions[case.mission], _settings(settings, case), sources[case.controller])
        for case in cases
    ]


def _cases(axes: Axes, missions: dict[str, Mission], guards: tuple[str, ...]) -> Iterator[Case]:
    for seed, name, wind, operator, delay, jitter, loss, controller, guard in itertools.product(
        range(axes.seeds),
        missions,
        axes.winds,
        axes.operators,
        axes.delays,
        axes.jitters,
        axes.losses,
        axes.controllers,
        guards,
    ):
        vehicle = missions[name].vehicle
        yield Case(
            controller=controller,
            guard=guard if _guarded(controller) else OFF,
            mission=name,
            delay=delay,
            jitter=jitter,
            loss=loss,
            wind=wind,
            operator=operator,
            seed=seed,
            rate=axes.rate,
            airframe=vehicle.airframe,
            model=vehicle.model,
        )


def _guarded(controller: str) -> bool:
    """Say whether a controller flies with a guard; the user's own do as the preset in the settings has it."""
    return controller not in PRESET_NAMES or PRESETS[Preset[controller.upper()]].guard


def _missions(axes: Axes) -> dict[str, Mission]:
    missions: dict[str, Mission] = {}
    for given in axes.missions:
        mission = _mission(given, axes)
        if mission.name in missions:
            raise InputError(
                f"--mission {given}: its name is {mission.name!r}, as another's; give each its own."
            )
        missions[mission.name] = mission
    return missions


def _mission(name: str, axes: Axes) -> Mission:
    """Read a mission and try whether its vehicle can be built."""
    mission = load_mission(find_mission(name))
    if mission.target is None:
        raise InputError(f"--mission {name}: has no target to fly to; an evaluation needs one.")
    choice = mission.vehicle
    choice = msgspec.structs.replace(
        choice, airframe=axes.airframe or choice.airframe, model=axes.model or choice.model
    )
    mission = msgspec.structs.replace(mission, vehicle=choice)
    try:
        build(scenario_of(mission, mission.wind))
    except ScenarioError as error:
        raise InputError(f"--mission {name}: {error}") from error
    return mission


def _settings(settings: Settings, case: Case) -> Settings:
    """Put the case's preset and guard into the settings."""
    replace = msgspec.structs.replace
    if case.controller in PRESET_NAMES:
        settings = replace(settings, control=replace(settings.control, preset=case.controller))
    return replace(settings, shield=replace(settings.shield, guard=case.guard))


def _source(spec: str, settings: Settings) -> str:
    """Try to make a controller, and return a fingerprint of its file, so that a changed one is flown anew."""
    if spec in PRESET_NAMES:
        return ""
    load_controller(spec, settings)
    found = importlib.util.find_spec(spec.partition(":")[0])
    if found is None or found.origin is None or not Path(found.origin).is_file():
        return ""
    return sha256(Path(found.origin).read_bytes()).hexdigest()[:20]
