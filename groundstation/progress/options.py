"""The options of `groundstation progress`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "how a pilot comes along: missions, skills, what is due, a certificate"
DESCRIPTION = """\
What a pilot has flown, mission by mission, the level of each skill, what is due to be repeated and what to fly next.
It is kept in progress.sqlite beside the recordings, on this machine only; see docs/school.md."""
EXAMPLES = """\
examples:
  groundstation progress                                       yours
  groundstation progress --pilot Ann                           another pilot's
  groundstation progress --pilot Ann --json                    the same for programs
  groundstation progress pilots                                everybody who flies here
  groundstation progress certificate Ann --out ann.pdf         what Ann has passed, to print (.pdf, .html or .md)
  groundstation progress import                                fill the store from all recordings of the folder
  groundstation progress forget Ann                            remove all that is kept of Ann

exit codes: 0 done; 1 import, and a recording could not be read; 2 bad input; 130 stopped
"""
RUN = "groundstation.progress.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("--pilot", metavar="NAME", help="whose (default: who is logged in)")
    parser.add_argument("--json", action="store_true", help="for programs: one JSON object")
    _add_logs(parser, Path("logs"))
    acts = parser.add_subparsers(dest="act", metavar="ACT")
    pilots = acts.add_parser("pilots", help="everybody who flies here")
    pilots.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="for programs")
    certificate = acts.add_parser("certificate", help="what a pilot has passed, to print")
    certificate.add_argument("name", metavar="PILOT", help="whose")
    certificate.add_argument(
        "--out", type=Path, metavar="FILE", help="a .pdf, .html or .md file (default: certificate.html)"
    )
    importing = acts.add_parser("import", help="fill the store from recordings; what is known stays as it is")
    importing.add_argument(
        "files", nargs="*", type=Path, metavar="FLIGHT.rrd", help="recordings (default: all of the folder)"
    )
    forget = acts.add_parser("forget", help="remove all that is kept of a pilot")
    forget.add_argument("name", metavar="PILOT", help="who")
    forget.add_argument("--yes", action="store_true", help="do not have the name typed again")
    for act in (pilots, certificate, importing, forget):
        _add_logs(act, argparse.SUPPRESS)


def _add_logs(parser: argparse.ArgumentParser, default: object) -> None:
    parser.add_argument(
        "--logs", type=Path, default=default, metavar="DIR", help="where recordings and progress are"
    )
