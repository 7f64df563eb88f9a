"""A link that is connected and cut off a thousand times: what its process keeps of it.

The real link process on a bus, and a real simulated vehicle; between them a TCP relay that hangs up as soon as the
vehicle's state has come through.
"""

from __future__ import annotations

import contextlib
import select
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from bench import gauges
from bench.rig import ROOT
from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.messages import EVENT, VEHICLE_STATE
from groundstation.run import Run, write_run
from groundstation.run_folder import new_run_id, sweep

FULL, SHORT = 1000, 25
MEMORY_BAR_MB = 1.0
_PATIENCE_S = 30.0
# What is made once, such as buffers and caches, is made in the first cycles.
_WARM_UP = 0.2


class Relay:
    """Carries bytes between who calls and the vehicle, until it hangs up.

    Args:
        vehicle: Port at which the vehicle listens.
    """

    def __init__(self, vehicle: int) -> None:
        self._vehicle = vehicle
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listener.getsockname()[1])
        self._ends: tuple[socket.socket, socket.socket] | None = None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._carry, daemon=True)
        self._thread.start()

    def hang_up(self) -> None:
        """Close both ends; the next call is taken."""
        ends, self._ends = self._ends, None
        for end in ends or ():
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()

    def close(self) -> None:
        """End the relay."""
        self._over.set()
        self._thread.join()
        self.hang_up()
        self._listener.close()

    def _carry(self) -> None:
        while not self._over.is_set():
            ends = self._ends
            # A connection that has been hung up meanwhile has no descriptor: the next turn has the new ones.
            with contextlib.suppress(OSError, ValueError):
                for each in select.select(ends or [self._listener], [], [], 0.1)[0]:
                    if ends is None:
                        self._join(self._listener.accept()[0])
                    elif data := each.recv(65536):
                        ends[each is ends[0]].sendall(data)
                    else:
                        self.hang_up()

    def _join(self, caller: socket.socket) -> None:
        try:
            self._ends = caller, socket.create_connection(("127.0.0.1", self._vehicle), 5.0)
        except OSError:
            caller.close()


class Link:
    """The real link process and its bus.

    Args:
        folder: Where its log goes.
        port: What it calls.
    """

    def __init__(self, folder: Path, port: int) -> None:
        url = f"tcpout://127.0.0.1:{port}"
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
def _vehicle() -> Iterator[int]:
    """Run a simulated vehicle and yield the port at which it listens."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = int(probe.getsockname()[1])
    command = [sys.executable, "-m", "sim", "--connect", f"tcpin://{port}", "--quiet"]
    with subprocess.Popen(command, cwd=ROOT) as process:
        try:
            yield port
        finally:
            process.terminate()


def cycles(count: int) -> list[gauges.Reading]:
    """Connect and cut off so many times; return a reading of the link after each."""
    readings: list[gauges.Reading] = []
    with tempfile.TemporaryDirectory() as folder, _vehicle() as port:
        relay = Relay(port)
        link = Link(Path(folder), relay.port)
        try:
            for _ in range(count):
                since = time.monotonic()
                link.hears(since)
                relay.hang_up()
                if reading := gauges.read(link.process.pid, time.monotonic()):
                    readings.append(reading)
        finally:
            link.close()
            relay.close()
    return readings


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    count = SHORT if short else FULL
    readings = cycles(count)
    grown = gauges.growth(readings[round(_WARM_UP * count) :])
    yield f"{count} times connected and cut off in {readings[-1].t - readings[0].t:.0f} s"
    bad = grown.memory > MEMORY_BAR_MB or grown.descriptors > 0
    yield f"link {grown} (≤ {MEMORY_BAR_MB:g} MB, 0 descriptors){'  VIOLATED' if bad else ''}"
