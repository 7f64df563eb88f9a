"""The options of `groundstation excite`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "fly what identification needs: bounded, axis by axis"
DESCRIPTION = """\
Take off, fly sums of sines on each axis and then on all at once, and land: a recording for 'groundstation identify'.
The hand does it, through the very processes of every flight, with the guard on and a fence around the start. Ctrl-C
ends it: the hand is uncoupled and the vehicle holds."""
EXAMPLES = """\
examples:
  groundstation excite --sim                                           the simulated vehicle
  groundstation excite --sim --airframe x500 --model rigid_body
  groundstation excite --connect udpin://0.0.0.0:14540 --confirm-real --room 8 --altitude 5
  groundstation excite --sim --axes up,yaw --seconds 12 --share 0.3    less, and only these

exit codes: 0 flown and landed, 1 it was given up or a process died, 2 bad input
"""
RUN = "groundstation.excite:run"
AXES = ("forward", "left", "up", "yaw")


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    vehicle = parser.add_mutually_exclusive_group(required=True)
    vehicle.add_argument("--sim", action="store_true", help="start and fly a simulated vehicle")
    vehicle.add_argument("--connect", metavar="URL", help="a real vehicle, as in 'groundstation --connect'")
    parser.add_argument("--confirm-real", action="store_true", help="with --connect: yes, fly it by itself")
    parser.add_argument(
        "--axes", default=",".join(AXES), metavar="NAMES", help=f"which (default: {','.join(AXES)})"
    )
    parser.add_argument(
        "--seconds",
        type=float,
        default=20.0,
        metavar="S",
        help="for each axis; all at once twice that (default: 20)",
    )
    parser.add_argument(
        "--share",
        type=float,
        default=0.5,
        metavar="SHARE",
        help="of the hand's full speed, at the peak (default: 0.5)",
    )
    parser.add_argument(
        "--room",
        type=float,
        default=6.0,
        metavar="M",
        help="free all around the start; a fence keeps it (default: 6)",
    )
    parser.add_argument(
        "--altitude", type=float, default=4.0, metavar="M", help="where it is flown (default: 4)"
    )
    parser.add_argument("--airframe", metavar="NAME", help="with --sim: a preset's name or a .toml file")
    parser.add_argument(
        "--model", choices=("kinematic", "dynamic", "rigid_body"), help="with --sim: motion model"
    )
    parser.add_argument(
        "--channel", metavar="KEY=VALUE,...", help="with --sim: what the way to the vehicle does"
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="with --sim (default: 0)")
    parser.add_argument("--config", type=Path, metavar="FILE", help="settings (default: groundstation.toml)")
    parser.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="recordings go here")
    parser.add_argument("--pilot", metavar="NAME", help="who flies (default: who is logged in)")
    parser.add_argument("--rerun", action="store_true", help="show the flight live in the Rerun viewer")
    parser.set_defaults(headless=True, json=False, device=None, controller="paper", mission="free")
