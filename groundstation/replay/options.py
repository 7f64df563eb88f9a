"""The options of `groundstation replay`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a recorded hand through today's pilot and simulator"
DESCRIPTION = "a recorded hand through today's pilot and simulator"
EXAMPLES = """\
examples:
"""
RUN = "groundstation.replay.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("log", nargs="?", type=Path, metavar="LOG", help="an .rrd file (default: the newest)")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
