"""A link that is connected and cut off a thousand times: what its process keeps of it.

The real link process on a bus, and a real simulated vehicle; between them a TCP relay that hangs up as soon as the
vehicle's state has come through, a serial port that is then pulled out and plugged in again, or UDP, where nothing
passes for a while.
"""

from __future__ import annotations

import contextlib
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

from bench import gauges, rig
from bench.radio import Radio, Relay
from bench.rig import ROOT, Tap
from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.messages import EVENT, VEHICLE_STATE
from groundstation.run import Run, write_run
from groundstation.run_folder import new_run_id, sweep

Way = Callable[[Path], AbstractContextManager[tuple[str, Callable[[], object]]]]

FULL, SHORT = 1000, 25
MEMORY_BAR_MB = 1.0
_PATIENCE_S = 30.0
# Longer than `safety.link_warning_s`, from which the vehicle counts as silent.
_SILENCE_S = 0.7
# What is made once, such as buffers and caches, is made in the first cycles.
_WARM_UP = 0.2


class Link:
    """The real link process and its bus.

    Args:
        folder: Where its log goes.
        url: What it calls.
    """

    def __init__(self, folder: Path, url: str) -> None:
        run = Run(
            run_id=new_run_id(), url=url, simulated=True, device="", mission=None, mission_path="",
            settings=Settings(), log=str(folder / "flight"), viewer_url="", started="",
        )  # fmt: skip
        self._run_id = run.run_id
        path = write_run(run)
        self._bus = Bus(run.run_id, "bench")
        self._states = self._bus.subscriber(VEHICLE_STATE)
        self._events = self._bus.subscriber(EVENT)
        self.process = subprocess.Popen([sys.executable, "-m", "groundstation.vehicle.link", path], cwd=ROOT)

    def hears(self, since: float) -> None:
        """Wait until the vehicle's state has come.

        Raises:
            SystemExit: It did not in time.
        """
        deadline = time.monotonic() + _PATIENCE_S
        while time.monotonic() < deadline:
            list(self._events.drain())
            if any(state.t > since for state in self._states.drain()):
                return
            time.sleep(0.005)
        raise SystemExit(f"the vehicle was not heard again within {_PATIENCE_S:.0f} s")

    def close(self) -> None:
        """End the process and leave its bus."""
        self.process.terminate()
        self.process.wait(10)
        self._bus.close()
        sweep(self._run_id)


@contextlib.contextmanager
def _vehicle(scheme: str) -> Iterator[int]:
    """Run a simulated vehicle and yield the port at which it waits."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = int(probe.getsockname()[1])
    command = [sys.executable, "-m", "sim", "--connect", f"{scheme}://{port}", "--quiet"]
    with subprocess.Popen(command, cwd=ROOT) as process:
        try:
            yield port
        finally:
            process.terminate()


@contextlib.contextmanager
def tcp(_folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield the address of a vehicle behind TCP, and what hangs up."""
    with _vehicle("tcpin") as port, contextlib.closing(Relay(port)) as relay:
        yield f"tcpout://127.0.0.1:{relay.port}", relay.hang_up


@contextlib.contextmanager
def serial(folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield the address of a vehicle behind a serial port, and what pulls it out and plugs it in again."""
    with _vehicle("udpin") as port, contextlib.closing(Radio(folder / "port", port)) as radio:

        def replug() -> None:
            radio.unplug()
            radio.plug()

        yield f"serial://{radio.name}:57600", replug


@contextlib.contextmanager
def udp(_folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield the address of a vehicle behind UDP, and what lets it be silent until that is told."""
    with contextlib.closing(Tap()) as tap, rig.vehicle(tap.vehicle_port):

        def fade() -> None:
            tap.passes = lambda _: False
            time.sleep(_SILENCE_S)
            for heard in (tap.heard, tap.said):
                heard.clear()
            tap.passes = lambda _: True

        yield f"udpout://127.0.0.1:{tap.program_port}", fade


def cycles(way: Way, count: int) -> list[gauges.Reading]:
    """Connect and cut off so many times; return a reading of the link after each."""
    readings: list[gauges.Reading] = []
    with (
        tempfile.TemporaryDirectory() as name,
        way(folder := Path(name)) as (url, cut),
        contextlib.closing(Link(folder, url)) as link,
    ):
        for _ in range(count):
            link.hears(time.monotonic())
            cut()
            if reading := gauges.read(link.process.pid, time.monotonic()):
                readings.append(reading)
    return readings


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    count = SHORT if short else FULL
    for way in (tcp, serial, udp):
        readings = cycles(way, count)
        grown = gauges.growth(readings[round(_WARM_UP * count) :])
        yield f"{way.__name__}: {count} times connected and cut off in {readings[-1].t - readings[0].t:.0f} s"
        bad = grown.memory > MEMORY_BAR_MB or grown.descriptors > 0
        yield f"link {grown} (≤ {MEMORY_BAR_MB:g} MB, 0 descriptors){'  VIOLATED' if bad else ''}"
