"""The options of `groundstation report`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a page on a flight, on several, on a class, or on the paper's experiments"
DESCRIPTION = """\
Write one page (HTML that needs nothing else, to mail or print) on a recorded flight: verdict, the paper's figures 9
to 13 for it, lateness, servo, passivity, what happened, score, settings. Or compare flights, or sum up a class."""
EXAMPLES = """\
examples:
  groundstation report                                the newest flight; the page lies beside the recording
  groundstation report 3 --pdf                        the third newest, as a PDF too
  groundstation report --compare A.rrd B.rrd          two or more flights side by side
  groundstation report --class --mission paper        all flights of a folder, pilot by pilot
  groundstation report --paper                        the paper's experiments flown anew, its figures 9 to 13

exit codes: 0 done; 1 --paper, and a bar does not hold; 2 bad input
"""
RUN = "groundstation.report.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument(
        "flights",
        nargs="*",
        type=Path,
        metavar="FLIGHT",
        help="recordings, or their numbers in 'review --list' (default: the newest)",
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--compare", action="store_true", help="the flights side by side")
    what.add_argument(
        "--class", dest="group", action="store_true", help="all flights given, or of the folder's pilots"
    )
    what.add_argument("--paper", action="store_true", help="the paper's experiments, flown in virtual time")
    parser.add_argument("--mission", metavar="NAME", help="with --class: flights of this mission only")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the page (default: beside the recording)")
    parser.add_argument("--pdf", action="store_true", help="write a PDF beside it too")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
    parser.add_argument(
        "--seed",
        type=int,
        default=0,
        metavar="N",
        help="with --paper: seed of all that is random (default: 0)",
    )
