"""The options of `groundstation identify`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a vehicle's dynamic model out of flights"
DESCRIPTION = """\
Identify the velocity response χ of a vehicle from flights: recordings (.rrd), PX4 logs (.ulg) or tables (.csv), and
validate it on others. docs/identify.md explains the method, the columns and what the figures mean."""
EXAMPLES = """\
examples:
  groundstation identify FLIGHT.rrd                                      the table, on itself
  groundstation identify a.ulg b.ulg --validate c.ulg                    on a flight it has not seen
  groundstation identify FLIGHT.rrd --out my.toml --page my.html         a preset and a page with the figures
  groundstation --sim --airframe my.toml --model dynamic                 fly what was found

exit codes: 0 done, 2 bad input
"""
RUN = "groundstation.identification.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument(
        "flights",
        nargs="+",
        type=Path,
        metavar="FLIGHT",
        help="recording, PX4 log or table; several count as one",
    )
    parser.add_argument(
        "--validate",
        nargs="+",
        type=Path,
        default=[],
        metavar="FLIGHT",
        help="flights to be told, not learned from",
    )
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="write an airframe (.toml) that --airframe takes"
    )
    parser.add_argument("--name", metavar="NAME", help="the airframe's (default: the file's)")
    parser.add_argument(
        "--like",
        default="matrice_100",
        metavar="AIRFRAME",
        help="whose size, speeds and battery the airframe has (default: matrice_100)",
    )
    parser.add_argument("--page", type=Path, metavar="FILE", help="write a page (.html) with figures")
    parser.add_argument("--json", action="store_true", help="the result as one JSON object")
