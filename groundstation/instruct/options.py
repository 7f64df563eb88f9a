"""The options of `groundstation instruct`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable

HELP = "let wind, delay and failures happen while a trainee flies"
DESCRIPTION = """\
At a second terminal beside a flight: see how the trainee is doing, and let wind, delay and failures happen. Without
an act it opens a screen with a key for each. Everything is recorded; the trainee is told nothing but what a real
vehicle would show. Wind, link and failures are for simulated vehicles; status, watch, say, hold and land for real
ones too. docs/instructor.md has more."""
EXAMPLES = """\
examples:
  groundstation instruct                          a screen with a key for each act
  groundstation instruct status                   how the trainee is doing
  groundstation instruct wind 5 0 --turbulence 1  from now on the air goes 5 m/s east, unsteadily
  groundstation instruct gust 0 -8                one gust towards the south, 4 s long
  groundstation instruct delay 300 --jitter 20    a round trip of 300 ms
  groundstation instruct link-loss 5              nothing is heard for 5 s
  groundstation instruct device-loss 10           as if the haptic device were unplugged
  groundstation instruct battery 12               12 % are left
  groundstation instruct calm                     all of it taken back
  groundstation instruct say "Look at the wind."  on the trainee's screen
  groundstation instruct --run alice watch        alice's flight, where several run

exit codes: 0 done; 1 refused, or nobody answered; 2 bad input, or there is no such flight; 130 stopped
"""
RUN = "groundstation.instruct.command:run"


# The shortest outage that is one, and the longest that the simulator allows, s.
_OUTAGE = (0.1, 60.0)
_AIR = 40.0


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument(
        "--run",
        metavar="NAME",
        help="which flight, where several run: its pilot, mission, run or process number",
    )
    acts = parser.add_subparsers(dest="act", metavar="ACT", title="acts")
    wind = acts.add_parser("wind", help="from now on the wind blows so")
    _add_air(wind)
    wind.add_argument(
        "--turbulence",
        type=number(0.0, 10.0),
        default=0.0,
        metavar="M/S",
        help="strength of its unsteady part",
    )
    gust = acts.add_parser("gust", help="one gust from now on")
    _add_air(gust)
    gust.add_argument(
        "--seconds", type=number(*_OUTAGE), default=4.0, metavar="S", help="from calm to calm (default: 4)"
    )
    delay = acts.add_parser("delay", help="from now on the link takes its time")
    delay.add_argument("round_trip", type=number(0.0, 2000.0), metavar="MS", help="there and back, ms")
    delay.add_argument(
        "--jitter",
        type=number(0.0, 1000.0),
        default=0.0,
        metavar="MS",
        help="up to so much more or less each way",
    )
    for name, unit, least, most, words in (
        ("loss", "PERCENT", 0.0, 95.0, "from now on the link loses so many frames, each way"),
        ("link-loss", "S", *_OUTAGE, "nothing crosses the link for so long"),
        ("device-loss", "S", *_OUTAGE, "the haptic device is gone for so long"),
        ("gps-loss", "S", *_OUTAGE, "the vehicle has no GPS for so long"),
        ("battery", "PERCENT", 1.0, 100.0, "so much charge is left"),
    ):
        act = acts.add_parser(name, help=words)
        told = f"{'seconds' if unit == 'S' else 'percent'}, {least:g} to {most:g}"
        act.add_argument("amount", type=number(least, most), metavar=unit, help=told)
    acts.add_parser("calm", help="take it back: wind and link as before, device and GPS there again")
    say = acts.add_parser("say", help="tell the trainee something, on their screen")
    say.add_argument("text", nargs="+", metavar="TEXT", help="what; quotes are not needed")
    acts.add_parser("hold", help="the vehicle stops and stays there; the hand is uncoupled")
    acts.add_parser("land", help="the vehicle lands where it is; the hand is uncoupled")
    acts.add_parser("status", help="how the trainee is doing, and what is in force")
    acts.add_parser("watch", help="the same, as it goes on")


def _add_air(parser: argparse.ArgumentParser) -> None:
    speed = number(-_AIR, _AIR)
    parser.add_argument("east", type=speed, metavar="E", help="towards the east, m/s")
    parser.add_argument("north", type=speed, metavar="N", help="towards the north, m/s")
    parser.add_argument(
        "up", type=speed, nargs="?", default=0.0, metavar="U", help="upward, m/s (default: 0)"
    )


def number(least: float, most: float) -> Callable[[str], float]:
    """Return what reads a number within a range."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {least:g} to {most:g}")
        return value

    return read
