"""The options of `groundstation review`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "look at recorded flights in the Rerun viewer"
DESCRIPTION = "Open a recording in the Rerun viewer; without one, the newest."
EXAMPLES = """\
examples:
  groundstation review                        the newest flight
  groundstation review --list                 what there is
  groundstation review FLIGHT.rrd --web       in a browser, on a machine without a display
"""
RUN = "groundstation.review.show:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("log", nargs="?", type=Path, metavar="LOG", help="an .rrd file (default: the newest)")
    parser.add_argument("--list", action="store_true", help="list the recorded flights, newest first")
    parser.add_argument("--web", action="store_true", help="serve the viewer to a browser on this machine")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
