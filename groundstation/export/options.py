"""The options of `groundstation export`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a recording as Parquet, CSV or MCAP"
DESCRIPTION = "a recording as Parquet, CSV or MCAP"
EXAMPLES = """\
examples:
"""
RUN = "groundstation.export.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("log", nargs="?", type=Path, metavar="LOG", help="an .rrd file (default: the newest)")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
