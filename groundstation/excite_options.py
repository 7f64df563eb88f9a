"""The options of `groundstation excite`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse

from groundstation import fly_options

HELP = "fly what identification needs: safe, bounded, axis by axis"
DESCRIPTION = """\
Take off, move the vehicle around one place by sines on every axis, land: the flight that 'groundstation identify'
learns a dynamic model from. The shield is on, the way is bounded before it is flown, and what will be flown is told
first. Ctrl-C ends it: the vehicle holds and lands. docs/excite.md says what is flown and why."""
EXAMPLES = """\
examples:
  groundstation excite --sim                                             the simulated vehicle, two and a half minutes
  groundstation excite --sim --airframe x500 --model rigid_body
  groundstation excite --connect udpin://0.0.0.0:14540 --confirm-real    a real one: it flies by itself
  groundstation excite --sim --axes forward,left --amplitude 0.3         gently, in the plane only

exit codes: 0 flown and landed, 1 it was not flown to its end, 2 bad input or no room, 130 stopped
"""
RUN = "groundstation.excite:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    fly_options.add_vehicle(parser)
    what = parser.add_argument_group("excitation")
    what.add_argument(
        "--axes",
        default="forward,left,up,yaw",
        metavar="NAMES",
        help="which, one after the other, then all at once (default: forward,left,up,yaw)",
    )
    what.add_argument(
        "--amplitude",
        type=float,
        default=0.5,
        metavar="SHARE",
        help="peak of the velocity as a share of the handle's full speed, 0.05 to 1 (default: 0.5)",
    )
    what.add_argument(
        "--seconds",
        type=float,
        default=20.0,
        metavar="N",
        help="how long an axis is moved, all at once twice as long (default: 20)",
    )
    what.add_argument("--band", default="0.1,1", metavar="LOW,HIGH", help="frequencies, Hz (default: 0.1,1)")
    what.add_argument("--altitude", type=float, metavar="M", help="where (default: as high as is needed)")
    what.add_argument(
        "--mission",
        metavar="NAME",
        help="whose obstacles and wind there are (default: calm with --sim, else none)",
    )
    what.add_argument("--confirm-real", action="store_true", help="with --connect: yes, fly it by itself")
    fly_options.add_simulated(parser)
    fly_options.add_recording(parser)
    # What a flight has besides: the scripted hand flies, by the paper's controller.
    parser.set_defaults(headless=True, json=False, device=None, controller="paper")
