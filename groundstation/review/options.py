"""The options of `groundstation review`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

HELP = "list recorded flights, look at one or two in the Rerun viewer"
DESCRIPTION = "Open a recording in the Rerun viewer, or two side by side; without one, the newest."
EXAMPLES = """\
examples:
  groundstation review                        the newest flight
  groundstation review --list                 what there is, with result and score
  groundstation review 3                      the third of the list
  groundstation review 1 --score              its score part by part, and where points were lost
  groundstation review 1 --at 31.5            the viewer at that moment of the recording
  groundstation review A.rrd B.rrd            two flights in one view, from the moment the hand was coupled
  groundstation review FLIGHT.rrd --web       in a browser, on a machine without a display

exit codes: 0 done, 2 bad input or no such flight, 130 stopped
"""
RUN = "groundstation.review.show:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument(
        "flights",
        nargs="*",
        type=Path,
        metavar="FLIGHT",
        help="one or two recordings, or their numbers in the list (default: the newest)",
    )
    parser.add_argument("--list", action="store_true", help="list the recorded flights, newest first")
    parser.add_argument(
        "--score", action="store_true", help="print the score and where points were lost; no viewer"
    )
    parser.add_argument("--at", type=_seconds, metavar="SECONDS", help="begin at this time of the recording")
    parser.add_argument("--mission", metavar="NAME", help="with --list: flights of this mission only")
    parser.add_argument("--pilot", metavar="NAME", help="with --list: flights of this pilot only")
    parser.add_argument("--json", action="store_true", help="with --list: as JSON")
    parser.add_argument("--web", action="store_true", help="serve the viewer to a browser on this machine")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="with two flights: keep the comparison (.rrd)"
    )
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0.0 <= seconds < math.inf:
        raise ValueError
    return seconds
