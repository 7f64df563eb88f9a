"""The options of `groundstation export`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a recording as Parquet, CSV or MCAP"
DESCRIPTION = """\
Write a recorded flight in another program's format: tables at every quantity's own rate, or one wide table, or an
MCAP file that Foxglove shows. Numbers are exactly those of the recording."""
EXAMPLES = """\
examples:
  groundstation export --to parquet                            the newest flight: a folder with a table a quantity
  groundstation export FLIGHT.rrd --to csv --hz 50             one table at 50 Hz
  groundstation export 2 --to mcap --out flight.mcap           the second newest, for Foxglove
  groundstation export FLIGHT.rrd --to csv --only '/pilot/*'   some of it

The .tlog beside a recording is MAVLink's own format: MAVProxy, QGroundControl and mavlogdump.py open it as it is.
exit codes: 0 done, 2 bad input, 130 stopped
"""
RUN = "groundstation.export.command:run"
FORMATS = ("parquet", "csv", "mcap")


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument(
        "flight",
        nargs="?",
        type=Path,
        metavar="FLIGHT",
        help="a recording, or its number in 'review --list' (default: the newest)",
    )
    parser.add_argument("--to", choices=FORMATS, required=True, help="which format")
    parser.add_argument(
        "--out", type=Path, metavar="PATH", help="file or folder (default: beside the recording)"
    )
    parser.add_argument(
        "--only",
        nargs="+",
        default=["*"],
        metavar="PATTERN",
        help="entities, as in docs/logs.md; * and ? stand for any",
    )
    parser.add_argument(
        "--hz", type=float, metavar="N", help="one wide table at this rate; values are held, not interpolated"
    )
    parser.add_argument("--start", type=float, default=0.0, metavar="S", help="from this time on, s")
    parser.add_argument("--end", type=float, default=float("inf"), metavar="S", help="up to this time, s")
    parser.add_argument("--force", action="store_true", help="replace what is there")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
