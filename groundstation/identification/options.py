"""The options of `groundstation identify`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a vehicle's dynamic model out of flights"
DESCRIPTION = "a vehicle's dynamic model out of flights"
EXAMPLES = """\
examples:
"""
RUN = "groundstation.identification.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("log", nargs="?", type=Path, metavar="LOG", help="an .rrd file (default: the newest)")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
