"""The options of `groundstation replay`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "a recorded hand through today's pilot and simulator: what if"
DESCRIPTION = """\
Fly a recorded hand once more, in virtual time: the handle's very motion through today's pilot and the simulator, with
the recording's mission, wind, seed and settings, or with others. What came out is set beside what was recorded.
With --check, today's pilot runs every tick again on its recorded inputs, and must decide the same to the last bit."""
EXAMPLES = """\
examples:
  groundstation replay                                         the newest flight, once more
  groundstation replay FLIGHT.rrd --preset transparent         with other cues and helps
  groundstation replay 2 --set control.k1=[2,2,2,1] --set mapping.fine=0.2
  groundstation replay FLIGHT.rrd --channel delay=0.15,loss=0.05 --wind calm
  groundstation replay FLIGHT.rrd --speed 1 --rerun            in its own time, in the viewer
  groundstation replay FLIGHT.rrd --out what_if.rrd            as a recording, for review and report --compare
  groundstation replay FLIGHT.rrd --check                      has the pilot's every decision stayed the same?
  groundstation replay FLIGHT.rrd --check --set control.k1=[2,2,2,1]   where does it decide otherwise first?

exit codes: 0 done, 1 a check found a difference, or the simulated vehicle did not take off, 2 bad input, 130 stopped
"""
RUN = "groundstation.replay.command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument(
        "flight",
        nargs="?",
        type=Path,
        metavar="FLIGHT",
        help="a recording, or its number in 'review --list' (default: the newest)",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="run the pilot's ticks again on their recorded inputs; fly nothing",
    )
    pilot = parser.add_argument_group("the pilot (default: as recorded)")
    pilot.add_argument("--config", type=Path, metavar="FILE", help="settings in place of the recorded ones")
    pilot.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="TABLE.KEY=VALUE",
        help="one setting; VALUE as in a .toml file",
    )
    pilot.add_argument(
        "--preset", choices=("paper", "assisted", "transparent", "training"), help="cues and helps"
    )
    pilot.add_argument("--controller", metavar="MODULE:CLASS", help="your own; see docs/control.md")
    world = parser.add_argument_group("vehicle and world (default: as recorded)")
    world.add_argument("--mission", metavar="NAME", help="another mission's world")
    world.add_argument("--airframe", metavar="NAME", help="a preset's name or a .toml file")
    world.add_argument("--model", choices=("kinematic", "dynamic", "rigid_body"), help="motion model")
    world.add_argument("--wind", choices=("calm", "mission"), default="mission", help="(default: mission)")
    world.add_argument(
        "--channel", default="", metavar="KEY=VALUE,...", help="such as delay=0.15,loss=0.05, each way"
    )
    world.add_argument("--seed", type=int, metavar="N", help="of all that is random")
    how = parser.add_argument_group("how")
    how.add_argument(
        "--speed", type=float, metavar="N", help="1 to 100 times life (default: as fast as it goes)"
    )
    live = how.add_mutually_exclusive_group()
    live.add_argument("--rerun", action="store_true", help="show it live in the Rerun viewer")
    live.add_argument(
        "--viewer", metavar="HOST:PORT", help="show it in a viewer that runs already, here or elsewhere"
    )
    how.add_argument("--out", type=Path, metavar="FILE", help="write it as a recording (.rrd)")
    how.add_argument("--json", action="store_true", help="the result as one JSON object")
    how.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")
