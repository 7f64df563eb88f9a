"""`groundstation missions new`: a mission file out of a seed or of a recorded flight."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import msgspec

from groundstation.errors import InputError
from groundstation.export import output
from groundstation.training.courses import course
from groundstation.training.listing import told
from groundstation.training.mission import Mission
from groundstation.training.writing import toml_of
from sim.scenario import ScenarioError

# What `--from` calls the newest recording, and `--out` the standard output.
LAST, STDOUT = "last", "-"


def run(asked: argparse.Namespace) -> int:
    """Make the mission, write it, check it; return the exit code: 0, or 1 where it cannot be flown as it is.

    Raises:
        InputError: What was asked for cannot be made or written.
    """
    to_file = asked.out != STDOUT
    name = asked.name or (Path(asked.out).stem if to_file else "")
    mission = _from_flight(asked, name) if asked.source else _from_seed(asked, name)
    if to_file:
        path = Path(asked.out)
        with output.written(path, folder=False, force=asked.force) as draft:
            draft.write_text(toml_of(mission), encoding="utf-8")
        print(f"{path}: written. Fly it: groundstation --sim --mission {path}", file=sys.stderr)
    else:
        print(toml_of(mission), end="")
    return told(asked.out if to_file else mission.name, mission, sys.stderr)


def _from_seed(asked: argparse.Namespace, name: str) -> Mission:
    if not asked.kind:
        raise InputError("what the course is made of is missing; give --kind, or --from a flight.")
    try:
        mission = course(asked.kind, asked.seed, asked.level, asked.airframe)
    except ScenarioError as error:
        raise InputError(f"--airframe {asked.airframe}: {error}") from error
    return _named(mission, name)


def _from_flight(asked: argparse.Namespace, name: str) -> Mission:
    from groundstation.review.choosing import chosen
    from groundstation.training.flown import mission_from

    path = chosen(None if asked.source == LAST else Path(asked.source), asked.logs)
    return _named(mission_from(path, "flown", asked.tolerance), name)


def _named(mission: Mission, name: str) -> Mission:
    """Give the mission a name, which must be one that a file may have.

    Raises:
        InputError: It is none.
    """
    plain = msgspec.to_builtins(mission) | ({"name": name} if name else {})
    try:
        return msgspec.convert(plain, Mission, strict=True)
    except msgspec.ValidationError as error:
        raise InputError(
            f"{name}: is no name for a mission (letters, digits, . and - only); give --name."
        ) from error
