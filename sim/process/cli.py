"""The simulator's command line: what the user asked for, checked, then made and run."""

from __future__ import annotations

import argparse
import contextlib
import math
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, get_args

from sim.airframe import PRESETS_FOLDER, SUFFIX, Model, load_airframe
from sim.conditions import HELP, BothWays, ConditionsError, parse_conditions
from sim.process.signing_key import KeyFileError, read_key
from sim.process.transport import Transport, TransportError, Url, open_transport, parse_url
from sim.scenario import STAND_ALONE, ScenarioError, load_scenario

if TYPE_CHECKING:
    from sim.process.vehicle import Vehicle
    from sim.simulator import Simulator

PROGRAM = "python -m sim"
EXIT_BAD_INPUT = 2
_LAST_SYSTEM_ID = 250
_FASTEST, _SLOWEST = 1000.0, 0.01
# Where PX4's simulated vehicles speak to (its px4-rc.mavlink): an API's port counts up, a ground station's does not.
_API_PORT, _LAST_API_PORT, _GROUND_STATION_PORT = 14540, 14549, 14550
# What flies where neither a mission nor the user says: PX4's own simulated vehicle.
_AIRFRAME = "x500"
# Vehicles stand side by side this far apart, in radii of the airframe, and at least so many metres.
_APART_RADII, _APART_M = 4.0, 2.0

_DESCRIPTION = "A lightweight multirotor that ground stations take for PX4."
_EPILOG = f"""\
examples:
  python -m sim                                          QGroundControl on this machine finds it by itself
  python -m sim --mission missions/paper.toml            in the paper's world, wind and obstacles
  python -m sim --airframe crazyflie                     another airframe, see --list-airframes
  python -m sim --connect udpout://192.168.1.20:14550    for a ground station elsewhere
  python -m sim --connect tcpin://5760 --connect serial:///dev/ttyUSB0:57600
  python -m sim --instances 3                            three: system ids 1 to 3, ports 14540 to 14542
  python -m sim --channel delay=0.15,jitter=0.03,loss=0.05,down.rate=5000
  python -m sim --speed 10 --quiet                       ten times as fast as the clock

connections, seen from the vehicle, and what 'groundstation --connect' is given to match:
  udpout://HOST:PORT       udpin://0.0.0.0:PORT      the vehicle speaks first
  udpin://[HOST:]PORT      udpout://VEHICLE:PORT     the vehicle waits
  tcpin://[HOST:]PORT      tcpout://VEHICLE:PORT     the vehicle waits
  tcpout://HOST:PORT                                 the vehicle calls one that listens, such as MAVProxy
  serial://DEVICE:BAUD     serial://DEVICE:BAUD      the two ends of a cable, or of a pair of radios
  Where HOST is left out, only this machine is listened to.

{HELP}
exit codes: 0 ended (Ctrl-C and SIGTERM included); 2 bad input
"""


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the whole usage."""

    def error(self, message: str) -> NoReturn:
        """End with exit code 2."""
        self.exit(EXIT_BAD_INPUT, f"{self.prog}: {message} (try --help)\n")


class _Version(argparse.Action):
    """Looks the version up only when asked."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from importlib.metadata import version

        print(f"groundstation sim {version('groundstation')}")  # noqa: T201
        parser.exit()


def build_parser() -> argparse.ArgumentParser:
    """Return the command line's parser."""
    parser = _Parser(
        prog=PROGRAM,
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and end")
    _add_vehicle(parser.add_argument_group("vehicle"))
    _add_connection(parser.add_argument_group("connection"))
    process = parser.add_argument_group("process")
    process.add_argument(
        "--speed",
        type=_number_in(_SLOWEST, _FASTEST),
        default=1.0,
        metavar="F",
        help="F times as fast as the clock (default: 1)",
    )
    process.add_argument("--quiet", action="store_true", help="no status line")
    process.add_argument(
        "--with-parent", action="store_true", help="end when the process that started it is gone"
    )
    return parser


def _add_vehicle(group: argparse._ArgumentGroup) -> None:  # pyright: ignore[reportPrivateUsage]
    group.add_argument(
        "--mission", type=Path, metavar="FILE", help="world, wind and vehicle (default: empty world)"
    )
    group.add_argument(
        "--airframe",
        metavar="NAME",
        help=f"a preset's name or a .toml file (default: the mission's, or {_AIRFRAME})",
    )
    group.add_argument("--list-airframes", action="store_true", help="list the presets and end")
    group.add_argument(
        "--model",
        choices=get_args(Model),
        help="motion model (default: the mission's, or the most complete that the airframe can fly)",
    )
    group.add_argument(
        "--instances",
        type=_whole_in(1, _LAST_SYSTEM_ID),
        default=1,
        metavar="N",
        help="N vehicles side by side; they do not collide with each other (default: 1)",
    )
    group.add_argument(
        "--seed",
        type=int,
        default=0,
        metavar="N",
        help="of all that is random; the next vehicle has the next (default: 0)",
    )


def _add_connection(group: argparse._ArgumentGroup) -> None:  # pyright: ignore[reportPrivateUsage]
    group.add_argument(
        "--connect",
        action="append",
        metavar="URL",
        help="a link, see below; may be repeated; ports count up from vehicle to vehicle "
        f"(default: udpout://127.0.0.1:{_API_PORT} for an API and :{_GROUND_STATION_PORT} for a ground station)",
    )
    group.add_argument(
        "--system-id",
        type=_whole_in(1, _LAST_SYSTEM_ID),
        default=1,
        metavar="ID",
        help="MAVLink system id of the first vehicle; they count up (default: 1)",
    )
    group.add_argument(
        "--signing-key",
        type=Path,
        metavar="FILE",
        help="sign, and hear only who signs: 32 bytes, or a passphrase and a newline",
    )
    group.add_argument(
        "--channel", default="", metavar="KEY=VALUE,...", help="delay, loss and more on all links, see below"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the vehicles until they are told to end; return the exit code."""
    asked = build_parser().parse_args(arguments)
    if asked.list_airframes:
        try:
            return _list_airframes()
        except BrokenPipeError:
            # Whoever read the list has gone (`| head`); that is no error of ours.
            sys.stderr.close()
            return 0
    from sim.process.fleet import Ending, run
    from sim.process.status_line import on_stdout

    ending = Ending(with_parent=asked.with_parent)
    try:
        vehicles = make_vehicles(asked, time.time())
    except (ScenarioError, TransportError, ConditionsError, KeyFileError) as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)  # noqa: T201
        return EXIT_BAD_INPUT
    # There is no standard output where the shell was told so with >&-.
    status = None if asked.quiet or sys.stdout is None else on_stdout()  # pyright: ignore[reportUnnecessaryComparison]
    if status:
        status.say(_introduction(vehicles))
    try:
        run(vehicles, asked.speed, ending, status)
    finally:
        for vehicle in vehicles:
            vehicle.close()
    return 0


def make_vehicles(asked: argparse.Namespace, unix_time: float) -> list[Vehicle]:
    """Make all vehicles that were asked for, with their links open.

    Raises:
        ScenarioError, TransportError, ConditionsError, KeyFileError: Something asked for cannot be.
    """
    from sim.process.vehicle import Vehicle

    both = _conditions(asked.channel)
    key = read_key(asked.signing_key) if asked.signing_key else None
    if key and asked.speed != 1.0:
        raise KeyFileError("--signing-key: signatures carry the clock's time; leave --speed out.")
    if asked.system_id + asked.instances - 1 > _LAST_SYSTEM_ID:
        raise ScenarioError(f"--system-id: the last vehicle's would be above {_LAST_SYSTEM_ID}; begin lower.")
    links = [_urls(asked.connect, number) for number in range(asked.instances)]
    makers = _makers(asked)
    with contextlib.ExitStack() as opened:
        vehicles: list[Vehicle] = []
        for number, (urls, make) in enumerate(zip(links, makers, strict=True)):
            transports: list[Transport] = []
            for url in urls:
                transports.append(open_transport(url))
                opened.callback(transports[-1].close)
            vehicles.append(
                Vehicle(
                    make,
                    transports,
                    both=both,
                    seed=asked.seed + number,
                    system_id=asked.system_id + number,
                    unix_time=unix_time,
                    key=key,
                )
            )
        opened.pop_all()
    return vehicles


def _conditions(text: str) -> BothWays:
    try:
        return parse_conditions(text)
    except ConditionsError as error:
        raise ConditionsError(f"--channel: {error}") from error


def _urls(given: list[str] | None, number: int) -> list[Url]:
    """Return the links of a vehicle; `number` counts from 0."""
    if given:
        return [parse_url(text).shifted(number) for text in given]
    api = min(_API_PORT + number, _LAST_API_PORT)
    return [Url("udpout", "127.0.0.1", port) for port in (api, _GROUND_STATION_PORT)]


def _makers(asked: argparse.Namespace) -> list[Callable[[], Simulator]]:
    """Return for each vehicle what makes its simulator: side by side to the right, seen along their noses."""
    from sim.simulator import build

    scenario = load_scenario(asked.mission) if asked.mission else STAND_ALONE
    name: str = asked.airframe or (scenario.vehicle.airframe if asked.mission else _AIRFRAME)
    airframe = load_airframe(name)
    # The last is the most complete that it has the numbers for.
    model: Model = asked.model or (scenario.vehicle.model if asked.mission else airframe.models()[-1])
    apart = max(_APART_M, _APART_RADII * airframe.radius)
    yaw = math.radians(scenario.vehicle.yaw_deg)

    def maker(number: int) -> Callable[[], Simulator]:
        start = (number * apart * math.sin(yaw), -number * apart * math.cos(yaw), 0.0)
        return lambda: build(scenario, name, model, seed=asked.seed + number, start=start)

    return [maker(number) for number in range(asked.instances)]


def _introduction(vehicles: Sequence[Vehicle]) -> str:
    first = vehicles[0]
    links = ", ".join(str(connection.transport.url) for connection in first.connections)
    title = first.simulator.airframe.title
    if len(vehicles) == 1:
        return f"{title}, system {first.system_id}: {links}. Ctrl-C ends it."
    last = vehicles[-1].system_id
    return f"{len(vehicles)} × {title}, systems {first.system_id} to {last}; the first: {links}. Ctrl-C ends them."


def _list_airframes() -> int:
    for path in sorted(PRESETS_FOLDER.glob(f"*{SUFFIX}")):
        airframe = load_airframe(path.stem)
        print(f"{path.stem:12} {airframe.title}: {', '.join(airframe.models())}", flush=True)  # noqa: T201
    return 0


def _whole_in(lowest: int, highest: int) -> Callable[[str], int]:
    def convert(text: str) -> int:
        number = int(text) if text.isascii() and text.isdigit() else lowest - 1
        if not lowest <= number <= highest:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {lowest} to {highest}")
        return number

    return convert


def _number_in(lowest: float, highest: float) -> Callable[[str], float]:
    def convert(text: str) -> float:
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not lowest <= number <= highest:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {lowest:g} to {highest:g}")
        return number

    return convert
