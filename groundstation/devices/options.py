"""The options of `groundstation devices`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "list, try out, calibrate or emulate haptic devices"
DESCRIPTION = "Without an act: what is connected."
EXAMPLES = """\
examples:
  groundstation devices                         what is connected, and what to give to --device
  groundstation devices test falcon             is it alive, are its axes right, can its force be felt
  groundstation devices calibrate joystick      centre and travel
  groundstation devices emulate falcon          a Falcon's double; prints what to give to --device
"""
RUN = "groundstation.devices_command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    parser.add_argument("--json", action="store_true", help="the list as JSON")
    parser.add_argument("--config", type=Path, metavar="FILE", help="settings (default: groundstation.toml)")
    acts = parser.add_subparsers(dest="act", metavar="ACT", help="default: list what is connected")
    acts.add_parser("list", help="what is connected, and what keeps the rest from being used")
    for name, words in (
        ("test", "see the workspace live, feel a force, confirm the axes' signs"),
        ("calibrate", "measure centre and travel; kept under the serial number"),
    ):
        act = acts.add_parser(name, help=words)
        act.add_argument("device", metavar="NAME[:ADDRESS]", help="as for --device")
    acts.choices["calibrate"].add_argument(
        "--forget", metavar="SERIAL", help="remove the calibration of a serial number ('' where it has none)"
    )
    emulate = acts.add_parser("emulate", help="run a double of a device, byte for byte, to fly with")
    emulate.add_argument("name", nargs="?", metavar="NAME", help="which (default: list those there are)")
    emulate.add_argument(
        "--hand",
        default="rest",
        metavar="WHAT",
        help="rest, circle, a recorded .csv, or a socket that moves it, see docs/devices.md (default: rest)",
    )
    emulate.add_argument("--link", type=Path, metavar="PATH", help="a path that leads to its port")
