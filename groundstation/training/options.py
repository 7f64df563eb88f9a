"""The options of `groundstation missions`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "list or check missions"
DESCRIPTION = "What there is to fly, and whether a mission file is right."
EXAMPLES = """\
examples:
  groundstation missions list
  groundstation missions check my_mission.toml
  groundstation missions measure my_mission.toml
"""
RUN = "groundstation.training.listing:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    acts = parser.add_subparsers(dest="act", metavar="ACT", required=True)
    acts.add_parser("list", help="what comes with the program")
    check = acts.add_parser("check", help="say whether mission files are right")
    check.add_argument("files", nargs="+", type=Path, metavar="FILE")
    measure = acts.add_parser(
        "measure",
        help="find a mission's par: simulated operators fly it in virtual time",
        description="""\
A novice, an average and an expert operator fly each mission on the same seeds, in virtual time, and once a hand that
does nothing. What they reach is written to reference/NAME.json beside the mission: its par, and a ghost to follow.
Exit codes: 0 measured, 1 a mission cannot be flown by the expert or is passed by doing nothing, 2 bad input,
130 stopped.""",
    )
    measure.add_argument("files", nargs="*", metavar="MISSION", help="names or files")
    measure.add_argument("--all", action="store_true", help="all that come with the program")
    measure.add_argument("--seeds", type=int, default=5, metavar="N", help="how many, from 0 (default: 5)")
    measure.add_argument(
        "--jobs", type=int, metavar="N", help="processes (default: as many as there are cores)"
    )
