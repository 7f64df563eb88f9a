"""`groundstation missions list` and `check`: what there is to fly, and whether a file is right."""

from __future__ import annotations

import argparse
import itertools
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from groundstation.errors import InputError
from groundstation.shown import shown
from groundstation.training.checking import faults, misplaced
from groundstation.training.curriculum import Lesson, lessons
from groundstation.training.mission import Mission, MissionError, load_mission
from groundstation.training.par import par_in
from groundstation.training.reference import load_reference, reference_fault
from sim.airframe import load_airframe
from sim.scenario import ScenarioError

_LEVELS = {1: "first steps", 2: "paths and landing", 3: "precision", 4: "trouble", 5: "mastery"}


def show_all(asked: argparse.Namespace) -> int:
    """Print the missions that come with the program in the order in which they are learned; return the exit code."""
    found = lessons()
    if asked.json:
        print(json.dumps([_fields(lesson) for lesson in found], indent=1))
        return 0
    names, skills = (max(map(len, words)) for words in zip(*map(_words, found), strict=True))
    print(f"{'':<{names + 2}}  {'trains':<{skills}}  {'par':>6}")
    for group, members in itertools.groupby(found, _group):
        print(group)
        for lesson in members:
            name, skill = _words(lesson)
            print(f"  {name:<{names}}  {skill:<{skills}}  {_par(lesson):>6}  {lesson.mission.title}")
    return 0


def check(asked: argparse.Namespace) -> int:
    """Say for every file whether it can be flown; return 0, 1 where one cannot, 2 where one is no mission."""
    found: dict[Path, Mission] = {}
    for path in asked.files:
        try:
            found[path] = load_mission(path)
        except MissionError as error:
            print(shown(f"groundstation: {error}"), file=sys.stderr)
    # A mission may need one that comes with the program, or one that is checked with it.
    known = {mission.name: mission for mission in (*(each.mission for each in lessons()), *found.values())}
    codes = [0 if found.keys() >= set(asked.files) else 2]
    for path, mission in found.items():
        codes.append(told(str(path), mission, sys.stdout, known))
        if mission.judged and (unmeasured := reference_fault(mission, path)):
            print(unmeasured)
    return max(codes)


def told(where: str, mission: Mission, out: TextIO, known: Mapping[str, Mission] | None = None) -> int:
    """Tell what is wrong with a mission, or that nothing is; return 0, or 1 where it cannot be flown as it is.

    Args:
        where: What to call it.
        mission: As loaded.
        out: Where to.
        known: The missions that it may need, by name; without them needs are not looked at.
    """
    try:
        found = faults(mission, load_airframe(mission.vehicle.airframe))
    except ScenarioError as error:
        raise InputError(f"{where}: vehicle.airframe: {error}") from error
    found += misplaced(mission, known) if known is not None else []
    for sentence in found:
        print(f"{where}: {sentence}", file=out)
    if not found:
        print(f"{where}: right ({mission.name}: {_count(mission)}).", file=out)
    return 1 if found else 0


def _count(mission: Mission) -> str:
    things = {
        "point": len(mission.waypoints) + (mission.target is not None),
        "obstacle": len(mission.obstacle),
        "event": len(mission.event),
    }
    return ", ".join(f"{count} {word}{'' if count == 1 else 's'}" for word, count in things.items())


def _group(lesson: Lesson) -> str:
    mission = lesson.mission
    return f"level {mission.level}: {_LEVELS[mission.level]}" if mission.judged else "free: nothing is judged"


def _words(lesson: Lesson) -> tuple[str, str]:
    """Return a mission's name and what it is mainly for."""
    return lesson.mission.name, lesson.mission.skills[0] if lesson.mission.skills else ""


def _par(lesson: Lesson) -> str:
    seconds = _par_s(lesson)
    return "" if seconds is None else f"{seconds:.0f} s"


def _par_s(lesson: Lesson) -> float | None:
    """Return how long the reference operator takes on seed 0, s; None where nobody has measured it."""
    par, _ = par_in(load_reference(lesson.mission, lesson.path), 0)
    return par.time_s if par else None


def _fields(lesson: Lesson) -> dict[str, object]:
    path, mission = lesson
    return {
        "name": mission.name,
        "title": mission.title,
        "teaches": mission.teaches,
        "level": mission.level,
        "skills": mission.skills,
        "needs": mission.needs,
        "judged": mission.judged,
        "par_s": _par_s(lesson),
        "file": str(path),
    }
