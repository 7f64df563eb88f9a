"""The options of `groundstation export`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a recording as Parquet, CSV or MCAP"
DESCRIPTION = """\
Write a recording for other programs: a folder of Parquet or CSV tables, one a quantity at its own rate; one wide
table at a rate of your choice (--hz); or an MCAP file that Foxglove opens. docs/export.md says what is in them."""
EXAMPLES = """\
examples:
  groundstation export --to parquet                                the newest flight, a folder beside the recording
  groundstation export 3 --to mcap                                 the third newest, for Foxglove
  groundstation export FLIGHT.rrd --to csv --hz 50                 one table, 50 rows a second
  groundstation export FLIGHT.rrd --to csv --entities '/handle/*' --start 5 --end 15

exit codes: 0 done, 2 bad input or nowhere to write, 130 stopped
"""
RUN = "groundstation.export.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument(
        "flight",
        nargs="?",
        type=Path,
        metavar="FLIGHT",
        help="a recording, or its number in 'review --list' (default: the newest)",
    )
    parser.add_argument("--to", required=True, choices=("parquet", "csv", "mcap"), help="as what")
    parser.add_argument(
        "--out", type=Path, metavar="PATH", help="the folder or file to write (default: beside the recording)"
    )
    parser.add_argument("--force", action="store_true", help="replace what an export wrote there before")
    what = parser.add_argument_group("what of it")
    what.add_argument(
        "--entities",
        "--only",
        nargs="+",
        metavar="GLOB",
        help="only these, as docs/logs.md lists them, such as '/handle/*' (default: all)",
    )
    what.add_argument(
        "--hz", type=float, metavar="N", help="one wide table, N rows a second, of what held then"
    )
    what.add_argument("--start", type=float, metavar="S", help="from S seconds after the run's start")
    what.add_argument("--end", type=float, metavar="S", help="up to S seconds after the run's start")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
