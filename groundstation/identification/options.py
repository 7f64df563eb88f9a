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
  groundstation identify FLIGHT.rrd                                      χ, and how well it tells the flight
  groundstation identify a.ulg b.ulg --validate c.ulg                    on a flight it has not seen
  groundstation identify FLIGHT.rrd --out my.toml --report my.html       an airframe, and a page with figures
  groundstation identify FLIGHT.csv --compare matrice_100                beside what is known of it
  groundstation --sim --model dynamic --airframe my.toml                 fly what was found

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
    parser.add_argument(
        "--compare",
        metavar="AIRFRAME",
        help="another airframe's χ beside it, and how well it tells the flights",
    )
    parser.add_argument(
        "--no-delay",
        action="store_true",
        help="take references to act at once: what is late goes into χ, as the simulator flies it",
    )
    parser.add_argument("--report", type=Path, metavar="FILE", help="write a page (.html) with figures")
    parser.add_argument("--json", action="store_true", help="the result as one JSON object")
