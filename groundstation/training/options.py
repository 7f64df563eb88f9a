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
"""
RUN = "groundstation.training.listing:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    acts = parser.add_subparsers(dest="act", metavar="ACT", required=True)
    acts.add_parser("list", help="what comes with the program")
    check = acts.add_parser("check", help="say whether mission files are right")
    check.add_argument("files", nargs="+", type=Path, metavar="FILE")
