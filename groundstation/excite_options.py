"""The options of `groundstation excite`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "fly what identification needs: safe, bounded, axis by axis"
DESCRIPTION = "fly what identification needs: safe, bounded, axis by axis"
EXAMPLES = """\
examples:
"""
RUN = "groundstation.excite:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("log", nargs="?", type=Path, metavar="LOG", help="an .rrd file (default: the newest)")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
