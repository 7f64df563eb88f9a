"""The options of a flight. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    add_vehicle(parser)
    add_flight(parser)
    add_simulated(parser)
    add_recording(parser)


def add_vehicle(parser: argparse.ArgumentParser) -> None:
    """Add which vehicle is flown."""
    group = parser.add_argument_group("vehicle (--sim or --connect)")
    vehicle = group.add_mutually_exclusive_group()
    vehicle.add_argument("--sim", action="store_true", help="start and fly a simulated vehicle")
    vehicle.add_argument(
        "--connect",
        metavar="URL",
        help="fly the vehicle at udpin://HOST:PORT, udpout://HOST:PORT, tcpout://HOST:PORT or serial://PORT:BAUD",
    )
    group.add_argument(
        "--signing-key",
        type=Path,
        metavar="FILE",
        help="sign, and hear only who signs (MAVLink 2): 32 bytes, or a passphrase, readable by you alone",
    )


def add_flight(parser: argparse.ArgumentParser) -> None:
    """Add how it is flown."""
    flight = parser.add_argument_group("flight")
    flight.add_argument(
        "--mission", metavar="NAME", help="a mission by name or .toml file (default: free flight)"
    )
    flight.add_argument(
        "--device", metavar="NAME[:ADDRESS]", help="haptic device (default: the on-screen stick)"
    )
    flight.add_argument(
        "--controller",
        default="paper",
        metavar="MODULE:CLASS",
        help="your own controller; see docs/control.md (default: the paper's)",
    )
    flight.add_argument(
        "--ghost",
        choices=("best", "reference", "off"),
        default="",
        help="whose flight to fly beside (default: your best, else the reference operator's)",
    )
    flight.add_argument(
        "--guidance",
        type=share,
        metavar="SHARE",
        help="how strongly the hand is guided to the mission's way, 0 to 1 (default: fades as you learn)",
    )
    flight.add_argument(
        "--headless", action="store_true", help="no screen: the scripted hand flies the mission"
    )
    flight.add_argument(
        "--operator",
        choices=("novice", "average", "expert"),
        help="with --headless: who flies, see docs/operators.md (default: average)",
    )
    flight.add_argument(
        "--plain",
        action="store_true",
        help="no screen: a line of status a second, commands as words from stdin (for screen readers and logs)",
    )
    flight.add_argument("--json", action="store_true", help="with --headless: the summary as one JSON object")
    flight.add_argument(
        "--confirm-real",
        action="store_true",
        help="with --headless --connect: yes, fly a real vehicle by itself",
    )


def add_simulated(parser: argparse.ArgumentParser) -> None:
    """Add what a simulated vehicle is."""
    sim = parser.add_argument_group("simulated vehicle (with --sim)")
    sim.add_argument(
        "--airframe", metavar="NAME", help="a preset's name or a .toml file (default: the mission's)"
    )
    sim.add_argument(
        "--model",
        choices=("kinematic", "dynamic", "rigid_body"),
        help="motion model (default: the mission's)",
    )
    sim.add_argument(
        "--channel",
        metavar="KEY=VALUE,...",
        help="what the way to the vehicle does, such as delay=0.15,loss=0.05; see 'python -m sim --help'",
    )
    sim.add_argument(
        "--seed", type=int, metavar="N", help="seed of all that is random (default: 0)", default=0
    )


def add_recording(parser: argparse.ArgumentParser) -> None:
    """Add settings, and where the recording goes."""
    general = parser.add_argument_group("settings and recording")
    general.add_argument("--config", type=Path, metavar="FILE", help="settings (default: groundstation.toml)")
    general.add_argument(
        "--pilot", metavar="NAME", help="who flies (default: who is logged in; --headless: nobody)"
    )
    general.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="recordings go here")
    live = general.add_mutually_exclusive_group()
    live.add_argument("--rerun", action="store_true", help="show the flight live in the Rerun viewer")
    live.add_argument(
        "--viewer", metavar="HOST:PORT", help="show it in a viewer that runs already, here or elsewhere"
    )


def share(text: str) -> float:
    """Read a number from 0 to 1.

    Raises:
        argparse.ArgumentTypeError: It is none.
    """
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"{text}: give a number from 0 to 1")
    return value
