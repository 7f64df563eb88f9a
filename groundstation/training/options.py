"""The options of `groundstation missions`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "what there is to fly; check missions, or make new ones"
DESCRIPTION = """\
What there is to fly, in the order in which it is learned; one mission as a trainee needs it; whether a mission file
can be flown; and new missions, out of a seed or of a recorded flight. docs/missions.md has the format."""
EXAMPLES = """\
examples:
  groundstation missions list                                        the exercises, from the first on
  groundstation missions show slalom                                 what it asks, how it is passed, a map
  groundstation missions check mine.toml                             can it be flown?
  groundstation missions measure mine.toml                           its par, by simulated operators
  groundstation missions new --kind forest --seed 7 --out wood.toml  an obstacle course
  groundstation missions new --kind gates --level 5 --out -          a hard one, to look at
  groundstation missions new --from last --out again.toml            the way of the last flight

exit codes: 0 done; 1 a mission cannot be flown as it is, and why is told; 2 bad input; 130 stopped
"""
_MEASURE = """\
A novice, an average and an expert operator fly each mission in virtual time, and once a hand that does nothing. What
they reach is written to reference/NAME.json beside the mission: its par, and a ghost to follow. It is not written
where the expert does not pass, or where doing nothing does: then the exit code is 1."""
RUN = "groundstation.missions_command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    acts = parser.add_subparsers(dest="act", metavar="ACT", required=True)
    listed = acts.add_parser("list", help="the exercises in the order in which they are learned")
    listed.add_argument("--json", action="store_true", help="as JSON")
    show = acts.add_parser("show", help="all about one mission, with a map")
    show.add_argument("mission", metavar="NAME", help="by name or .toml file")
    check = acts.add_parser("check", help="say whether missions can be flown, and what is wrong")
    check.add_argument("files", nargs="+", type=Path, metavar="FILE", help="mission files (.toml)")
    _fill_new(acts.add_parser("new", help="make a mission out of a seed or of a recorded flight"))
    _fill_measure(
        acts.add_parser("measure", help="find the par: simulated operators fly it", description=_MEASURE)
    )


def _fill_measure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("missions", nargs="*", metavar="NAME", help="by name or .toml file")
    parser.add_argument("--all", action="store_true", help="all that come with the program")
    parser.add_argument("--seeds", type=int, default=5, metavar="N", help="how many, from 0 (default: 5)")
    parser.add_argument(
        "--jobs", type=int, metavar="N", help="processes (default: as many as there are cores)"
    )


def _fill_new(parser: argparse.ArgumentParser) -> None:
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--kind", choices=("slalom", "gates", "forest", "corridor"), help="an obstacle course of this kind"
    )
    source.add_argument(
        "--from",
        dest="source",
        metavar="FLIGHT",
        help="the way of a recording, of its number in 'review --list', or of the 'last' one",
    )
    parser.add_argument("--out", required=True, metavar="FILE", help="where to write it; - for the terminal")
    parser.add_argument("--force", action="store_true", help="replace FILE")
    parser.add_argument("--name", metavar="NAME", help="the mission's name (default: that of FILE)")
    course = parser.add_argument_group("course")
    course.add_argument("--seed", type=int, default=0, help="of where things stand (default: 0)")
    course.add_argument(
        "--level", type=int, choices=range(1, 6), default=3, help="1 roomy to 5 narrow, in wind (default: 3)"
    )
    course.add_argument(
        "--airframe",
        metavar="NAME",
        default="hummingbird",
        help="that flies it, and has room: a preset or a .toml file (default: hummingbird)",
    )
    flight = parser.add_argument_group("flight")
    flight.add_argument(
        "--tolerance",
        type=_metres,
        default=0.3,
        metavar="M",
        help="how far its legs may be off the way flown, m (default: 0.3)",
    )
    flight.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")


def _metres(text: str) -> float:
    value = float(text)
    if not 0.0 < value <= 100.0:
        raise argparse.ArgumentTypeError(f"{text}: must be above 0 and at most 100 m")
    return value
