"""The command line: what the user asked for, checked, then handed to the part that does it.

Nothing heavy is imported before it is needed: `--help` must answer at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from groundstation import __version__
from groundstation.errors import InputError
from groundstation.evaluation import options

PROGRAM = "groundstation"
EXIT_BAD_INPUT = 2

_EXAMPLES = """\
examples:
  groundstation --sim                                        fly the simulated vehicle
  groundstation --sim --mission paper                        fly a mission by hand
  groundstation --sim --headless --mission paper --json      let the scripted hand fly it
  groundstation --connect udpin://0.0.0.0:14540              fly a real PX4 vehicle
  groundstation --connect serial:///dev/ttyUSB0:57600        the same through a radio
  groundstation review                                       look at the last flight
  groundstation report --paper                               the paper's figures, flown anew
  groundstation evaluate --delay 0,0.1,0.3                   compare controllers over hundreds of virtual flights
  groundstation missions list                                what there is to fly

exit codes: 0 done, or the mission's criteria hold; 1 they do not, or a process died; 2 bad input
"""


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the whole usage."""

    def error(self, message: str) -> NoReturn:
        """End with exit code 2."""
        self.exit(EXIT_BAD_INPUT, f"{self.prog}: {message} (try --help)\n")


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    parser = _Parser(
        prog=PROGRAM,
        description="Ground station for bilateral haptic teleoperation of multirotors: feel the drone.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {__version__}")
    _add_flight(parser)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", title="commands besides flying")
    _fill_review(
        commands.add_parser(
            "review",
            help="look at a recorded flight in the Rerun viewer",
            description="Open a recording in the Rerun viewer; without one, the newest.",
        )
    )
    _fill_report(commands.add_parser("report", help="the paper's figures, flown anew", description=_REPORT))
    options.fill(
        commands.add_parser(
            "evaluate",
            help="compare controllers over many flights in virtual time",
            description=options.DESCRIPTION,
            epilog=options.EXAMPLES,
            formatter_class=_RAW,
        )
    )
    _fill_missions(commands.add_parser("missions", help="list or check missions"))
    _fill_devices(
        commands.add_parser(
            "devices",
            help="list, try out, calibrate or emulate haptic devices",
            epilog=_DEVICE_EXAMPLES,
            formatter_class=_RAW,
        )
    )
    completion = commands.add_parser(
        "completion", help="print a shell's completion script", description=_COMPLETION, formatter_class=_RAW
    )
    completion.add_argument("shell", choices=("bash", "zsh", "tcsh"))
    return parser


_DEVICE_EXAMPLES = """\
examples:
  groundstation devices                         what is connected, and what to give to --device
  groundstation devices test falcon             is it alive, are its axes right, can its force be felt
  groundstation devices calibrate joystick      centre and travel
  groundstation devices emulate falcon          a Falcon's double; prints what to give to --device
"""
_RAW = argparse.RawDescriptionHelpFormatter
_REPORT = """\
Fly the paper's experiments on the simulated vehicle, in virtual time, and write its figures 9 to 13 with their
numbers as one page. Exit code 0 when every bar holds."""
_COMPLETION = """\
Print a completion script. For bash:
  groundstation completion bash > ~/.local/share/bash-completion/completions/groundstation"""


def _add_flight(parser: argparse.ArgumentParser) -> None:
    vehicle = parser.add_argument_group("vehicle (one of)").add_mutually_exclusive_group()
    vehicle.add_argument("--sim", action="store_true", help="start and fly a simulated vehicle")
    vehicle.add_argument(
        "--connect",
        metavar="URL",
        help="fly the vehicle at udpin://HOST:PORT, udpout://HOST:PORT, tcpout://HOST:PORT or serial://PORT:BAUD",
    )
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
        "--headless", action="store_true", help="no screen: the scripted hand flies the mission"
    )
    flight.add_argument("--json", action="store_true", help="with --headless: the summary as one JSON object")
    flight.add_argument(
        "--confirm-real",
        action="store_true",
        help="with --headless --connect: yes, fly a real vehicle by itself",
    )
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
    general = parser.add_argument_group("settings and recording")
    general.add_argument("--config", type=Path, metavar="FILE", help="settings (default: groundstation.toml)")
    general.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="recordings go here")
    general.add_argument("--rerun", action="store_true", help="show the flight live in the Rerun viewer")


def _fill_review(review: argparse.ArgumentParser) -> None:
    review.add_argument("log", nargs="?", type=Path, metavar="LOG", help="an .rrd file (default: the newest)")
    review.add_argument("--list", action="store_true", help="list the recorded flights, newest first")
    review.add_argument("--web", action="store_true", help="serve the viewer to a browser on this machine")
    review.add_argument("--logs", type=Path, default=Path("logs"), metavar="DIR", help="where recordings are")


def _fill_report(report: argparse.ArgumentParser) -> None:
    report.add_argument("--paper", action="store_true", required=True, help="on the paper's experiments")
    report.add_argument(
        "--out", type=Path, default=Path("paper.html"), metavar="FILE", help="the page (default: paper.html)"
    )
    report.add_argument("--pdf", action="store_true", help="write a PDF beside it too")
    report.add_argument(
        "--seed", type=int, default=0, metavar="N", help="seed of all that is random (default: 0)"
    )


def _fill_missions(missions: argparse.ArgumentParser) -> None:
    acts = missions.add_subparsers(dest="act", metavar="ACT", required=True)
    acts.add_parser("list", help="what comes with the program")
    check = acts.add_parser("check", help="say whether mission files are right")
    check.add_argument("files", nargs="+", type=Path, metavar="FILE")


def _fill_devices(devices: argparse.ArgumentParser) -> None:
    devices.add_argument("--json", action="store_true", help="the list as JSON")
    devices.add_argument("--config", type=Path, metavar="FILE", help="settings (default: groundstation.toml)")
    acts = devices.add_subparsers(dest="act", metavar="ACT", help="default: list what is connected")
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


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its code."""
    parser = build_parser()
    asked = parser.parse_args(arguments)
    try:
        code = _dispatch(parser, asked)
    except InputError as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        code = EXIT_BAD_INPUT
    except KeyboardInterrupt:
        code = 130
    except BrokenPipeError:
        # Whoever read our output has gone (`| head`); that is no error of ours.
        sys.stderr.close()
        code = 0
    sys.exit(code)


def _dispatch(parser: argparse.ArgumentParser, asked: argparse.Namespace) -> int:
    if asked.command == "completion":
        import shtab

        print(shtab.complete(parser, shell=asked.shell))
        return 0
    if asked.command == "missions":
        from groundstation.training import listing

        return listing.show() if asked.act == "list" else listing.check(asked.files)
    if asked.command == "devices":
        return _devices(asked)
    if asked.command == "review":
        return _review(asked)
    if asked.command == "evaluate":
        from groundstation.evaluation import command

        return command.evaluate(asked)
    if asked.command == "report":
        from groundstation.review import paper

        return paper.report(asked.out, asked.seed, pdf=asked.pdf)
    if not asked.sim and not asked.connect:
        parser.print_help()
        return EXIT_BAD_INPUT
    from groundstation import fly

    return fly.fly(asked)


def _devices(asked: argparse.Namespace) -> int:
    if asked.act == "emulate":
        from groundstation.devices import emulating

        if asked.name is None:
            return emulating.listing()
        return emulating.emulate(asked.name, asked.hand, asked.link)
    if asked.act in (None, "list"):
        from groundstation.devices import listing

        return listing.show(as_json=asked.json, config=asked.config)
    from groundstation.devices import calibrating, making

    if asked.act == "calibrate" and asked.forget is not None:
        return calibrating.forget(asked.device.partition(":")[0], asked.forget)
    device = making.raw_device(asked.device, asked.config)
    if asked.act == "calibrate":
        return calibrating.calibrate(asked.device.partition(":")[0], device)
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise InputError("devices test draws on a terminal; run it in one.")
    from groundstation.tui import device_test

    return device_test.try_out(making.calibrated(device, asked.device))


def _review(asked: argparse.Namespace) -> int:
    from groundstation.review import show

    return show.list_all(asked.logs) if asked.list else show.show(asked.log, asked.logs, web=asked.web)


if __name__ == "__main__":
    main()
