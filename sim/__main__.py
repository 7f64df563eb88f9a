"""The simulated vehicle as a process: physics at 250 Hz, in real time, behind a MAVLink connection."""

from __future__ import annotations

import argparse
import gc
import math
import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from sim.pacing import Pacer
from sim.scenario import Scenario, ScenarioError, load_scenario
from sim.transport import Transport, TransportError, open_transport

if TYPE_CHECKING:
    from sim.mavlink.endpoint import Endpoint
    from sim.simulator import Simulator

PROGRAM = "python -m sim"
STEP_S = 0.004
DEFAULT_URL = "udpout://127.0.0.1:14540"
EXIT_BAD_INPUT = 2
_STATUS_EVERY = 250
_PARENT_EVERY = 25

_EXAMPLES = """\
examples:
  python -m sim                                          a vehicle for the ground station on this machine
  python -m sim --mission missions/paper.toml            in the paper's world, wind and obstacles
  python -m sim --connect udpout://192.168.1.20:14540    for a ground station elsewhere
  python -m sim --connect tcpin://5760 --airframe x500   wait for a ground station, with another airframe
"""


def build_parser() -> argparse.ArgumentParser:
    """Return the command line's parser."""
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        description="A lightweight multirotor that ground stations take for PX4.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--connect",
        default=DEFAULT_URL,
        metavar="URL",
        help=f"udpout://HOST:PORT, udpin://[HOST:]PORT or tcpin://[HOST:]PORT (default: {DEFAULT_URL})",
    )
    parser.add_argument(
        "--mission", type=Path, metavar="FILE", help="world, wind and vehicle (default: empty world)"
    )
    parser.add_argument(
        "--airframe", metavar="NAME", help="a preset's name or a .toml file (default: the mission's)"
    )
    parser.add_argument(
        "--model", choices=("kinematic", "dynamic"), help="motion model (default: the mission's)"
    )
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="seed of the sensors' noise (default: 0)"
    )
    parser.add_argument("--quiet", action="store_true", help="no status line")
    parser.add_argument(
        "--with-parent", action="store_true", help="end when the process that started it is gone"
    )
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the vehicle until it is told to end; return the exit code."""
    asked = build_parser().parse_args(arguments)
    ended = Ending(with_parent=asked.with_parent)
    try:
        scenario = load_scenario(asked.mission) if asked.mission else Scenario()
        from sim.simulator import build

        simulator = build(scenario, asked.airframe, asked.model)
        transport = open_transport(asked.connect)
    except (ScenarioError, TransportError) as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)  # noqa: T201
        return EXIT_BAD_INPUT
    from sim.mavlink.endpoint import Endpoint

    endpoint = Endpoint(simulator, asked.seed, time.time())
    if not asked.quiet:
        scheme = asked.connect.partition("://")[0]
        print(f"{simulator.airframe.title}, {scheme} port {transport.port}; Ctrl-C ends it.")  # noqa: T201
    try:
        run(simulator, endpoint, transport, ended, quiet=asked.quiet)
    finally:
        transport.close()
    return 0


class Ending:
    """Knows when to end: on SIGTERM, SIGINT or SIGHUP, and with the parent where asked to.

    Args:
        with_parent: End when the process that started this one is gone.
    """

    def __init__(self, *, with_parent: bool) -> None:
        self._parent = os.getppid() if with_parent else None
        self.told = False
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            signal.signal(number, self._end)

    def orphaned(self) -> bool:
        """Say whether the parent is gone."""
        return self._parent is not None and os.getppid() != self._parent

    def _end(self, _number: int, _frame: FrameType | None) -> None:
        self.told = True


def run(
    simulator: Simulator, endpoint: Endpoint, transport: Transport, ending: Ending, *, quiet: bool
) -> None:
    """Step, answer, tell and wait, until the end."""
    gc.freeze()
    pacer = Pacer(STEP_S, time.monotonic, time.sleep)
    tick = 0
    while not ending.told:
        for data in transport.receive():
            endpoint.receive(data, whole=transport.whole)
        simulator.step(STEP_S)
        endpoint.step()
        for datagram in endpoint.outgoing():
            transport.send(datagram)
        if tick % _PARENT_EVERY == 0 and ending.orphaned():
            return
        if not quiet and tick % _STATUS_EVERY == 0:
            print(f"\r{status(simulator)}", end="", flush=True)  # noqa: T201
        tick += 1
        pacer.wait()
    if not quiet:
        print()  # noqa: T201


def status(simulator: Simulator) -> str:
    """Return one line on how the vehicle is."""
    x, y, z, yaw = simulator.p
    autopilot = simulator.autopilot
    armed = "armed" if autopilot.armed else "disarmed"
    return (
        f"{autopilot.mode.value:9}{armed:9} x {x:7.2f}  y {y:7.2f}  z {z:6.2f} m  yaw {math.degrees(yaw):4.0f}°  "
        f"battery {simulator.battery.remaining:4.0%}  collisions {len(simulator.collisions)}"
    )


if __name__ == "__main__":
    sys.exit(main())
