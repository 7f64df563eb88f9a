"""`groundstation missions`: what there is to fly, and whether a file is right."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from groundstation.training.mission import MISSIONS_FOLDER, SUFFIX, MissionError, load_mission


def run(asked: argparse.Namespace) -> int:
    """Do what was asked and return the exit code."""
    if asked.act == "measure":
        from groundstation.operators.measure import run as measure

        return measure(asked)
    return show() if asked.act == "list" else check(asked.files)


def show() -> int:
    """Print the missions that come with the program, a line each; return the exit code."""
    for path in sorted(MISSIONS_FOLDER.glob(f"*{SUFFIX}")):
        mission = load_mission(path)
        print(f"{path.stem:<12} {mission.title}")
    return 0


def check(files: Sequence[Path]) -> int:
    """Say for every file whether it is a mission; return 0 when all are, else 2."""
    code = 0
    for path in files:
        try:
            mission = load_mission(path)
        except MissionError as error:
            print(f"groundstation: {error}", file=sys.stderr)
            code = 2
        else:
            print(
                f"{path}: right ({mission.name}: {len(mission.obstacle)} obstacles, {len(mission.way)} legs)."
            )
    return code
