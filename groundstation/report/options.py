"""The options of `groundstation report`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a page on a flight, or on the paper's experiments flown anew"
DESCRIPTION = """\
Fly the paper's experiments on the simulated vehicle, in virtual time, and write its figures 9 to 13 with their
numbers as one page. Exit code 0 when every bar holds."""
EXAMPLES = """\
examples:
  groundstation report --paper                the paper's figures, flown anew
"""
RUN = "groundstation.report.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("--paper", action="store_true", required=True, help="on the paper's experiments")
    parser.add_argument(
        "--out", type=Path, default=Path("paper.html"), metavar="FILE", help="the page (default: paper.html)"
    )
    parser.add_argument("--pdf", action="store_true", help="write a PDF beside it too")
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="seed of all that is random (default: 0)"
    )
