"""The options of `groundstation preflight`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse

from groundstation import fly_options

HELP = "every check before a flight, without a screen, with an exit code"
DESCRIPTION = """\
Connect to the vehicle and the haptic device, make every check of Preflight (F7), and say of each how it is and what
to do. Nothing is armed, coupled or recorded. It waits until nothing is red, at most --wait seconds: a vehicle that
has just been switched on needs its time."""
EXAMPLES = """\
examples:
  groundstation preflight --connect udpin://0.0.0.0:14540
  groundstation preflight --connect serial:///dev/ttyUSB0:57600 --wait 60
  groundstation preflight --connect serial:///dev/ttyUSB0:57600 --device inverse3 --mission box
  groundstation preflight --connect udpin://0.0.0.0:14540 > preflight.txt      to print, or to keep
  groundstation preflight --connect udpin://0.0.0.0:14540 --json               for programs
  groundstation preflight --sim                                                the simulated vehicle

exit codes: 0 may be flown, 1 something is red, 2 bad input, 130 stopped
"""
RUN = "groundstation.preflight:run"
_WAIT_S = 30.0


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    fly_options.add_vehicle(parser)
    what = parser.add_argument_group("checks")
    what.add_argument(
        "--wait", type=seconds, default=_WAIT_S, metavar="S", help=f"for what is red (default: {_WAIT_S:g} s)"
    )
    what.add_argument("--json", action="store_true", help="the checks as one JSON object")
    what.add_argument(
        "--mission",
        metavar="NAME",
        help="a mission by name or .toml file, for its fence (default: free flight)",
    )
    what.add_argument(
        "--device", metavar="NAME[:ADDRESS]", help="haptic device (default: the on-screen stick)"
    )
    fly_options.add_simulated(parser)
    fly_options.add_recording(parser)
    parser.set_defaults(headless=False, plain=True, controller="paper")


def seconds(text: str) -> float:
    """Read how long to wait.

    Raises:
        argparse.ArgumentTypeError: It is no such time.
    """
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= 3600.0:
        raise argparse.ArgumentTypeError(f"{text}: give seconds, 0 to 3600")
    return value
