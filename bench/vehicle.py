"""The simulated vehicle as a process: start, memory, and the share of a core it takes in real time.

Start is from the command to the first heartbeat on the socket. The share is processor time over time while it hovers,
physics at 250 Hz, every stream at PX4's rates on a link that is read.
"""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from pymavlink.dialects.v20 import common as m

from bench.rig import ROOT, percentile

BAR_START_S, BAR_MEMORY_MB, BAR_SHARE = 0.6, 80.0, 0.10
_PATIENCE_S = 30.0


class Listener:
    """A ground station that reads all it is told on one port, and counts it."""

    def __init__(self, port: int = 0) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", port))
        self._socket.settimeout(_PATIENCE_S)
        self.port = int(self._socket.getsockname()[1])
        self.bytes = 0
        self._peer = None
        self._running = True
        self._thread = threading.Thread(target=self._read, daemon=True)

    def first(self) -> float:
        """Return when the first heartbeat came, monotonic s."""
        while True:
            data, self._peer = self._socket.recvfrom(65536)
            if data[0] == 0xFD and int.from_bytes(data[7:10], "little") == m.MAVLINK_MSG_ID_HEARTBEAT:
                return time.monotonic()

    def take_off(self, system: int) -> None:
        """Have the vehicle fly."""
        packer = m.MAVLink(None, srcSystem=245, srcComponent=190)
        for command, first in ((m.MAV_CMD_COMPONENT_ARM_DISARM, 1.0), (m.MAV_CMD_NAV_TAKEOFF, 0.0)):
            nan = float("nan")
            message = m.MAVLink_command_long_message(system, 1, command, 0, first, 0, 0, nan, nan, nan, nan)
            self._socket.sendto(message.pack(packer), self._peer)

    def read_on(self) -> None:
        """Read in the background from now on."""
        self._thread.start()

    def close(self) -> None:
        """End."""
        self._running = False
        self._socket.settimeout(0.1)
        if self._thread.is_alive():
            self._thread.join()
        self._socket.close()

    def _read(self) -> None:
        self._socket.settimeout(0.2)
        while self._running:
            with contextlib.suppress(TimeoutError):
                self.bytes += len(self._socket.recv(65536))


@contextlib.contextmanager
def running(first_port: int, *options: str, cache: str | None = None) -> Iterator[subprocess.Popen[bytes]]:
    """Run vehicles that speak to a port; `cache` is where Python keeps its bytecode; None: as found."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    environment |= {"PYTHONPYCACHEPREFIX": cache} if cache else {"PYTHONDONTWRITEBYTECODE": "1"}
    command = [
        sys.executable,
        "-m",
        "sim",
        "--quiet",
        "--connect",
        f"udpout://127.0.0.1:{first_port}",
        *options,
    ]
    process = subprocess.Popen(command, cwd=ROOT, env=environment)
    try:
        yield process
    finally:
        process.terminate()
        process.wait(10)


def start_s(cache: str | None) -> tuple[float, float]:
    """Return how long a start took, s, and the memory afterwards, MB."""
    listener = Listener()
    begun = time.monotonic()
    with running(listener.port, cache=cache) as process:
        took = listener.first() - begun
        listener.read_on()
        time.sleep(1.0)
        memory = resident_mb(process.pid)
    listener.close()
    return took, memory


def share(cache: str, model: str, instances: int, seconds: float) -> tuple[float, float, float]:
    """Fly; return the share of a core, what is told each second and vehicle, kB, and memory, MB."""
    listeners = consecutive(instances)
    with running(
        listeners[0].port, "--model", model, "--instances", str(instances), "--airframe", "x500", cache=cache
    ) as process:
        for number, listener in enumerate(listeners):
            listener.first()
            listener.take_off(number + 1)
            listener.read_on()
        time.sleep(4.0)
        begun, before, told = (
            time.monotonic(),
            processor_s(process.pid),
            sum(each.bytes for each in listeners),
        )
        time.sleep(seconds)
        took = time.monotonic() - begun
        used = processor_s(process.pid) - before
        rate = (sum(each.bytes for each in listeners) - told) / took / instances / 1e3
        memory = resident_mb(process.pid)
    for listener in listeners:
        listener.close()
    return used / took, rate, memory


def consecutive(count: int) -> list[Listener]:
    """Return listeners on ports that follow one another."""
    while True:
        listeners = [Listener()]
        try:
            for _ in range(count - 1):
                listeners.append(Listener(listeners[-1].port + 1))
        except (OSError, OverflowError):
            for listener in listeners:
                listener.close()
        else:
            return listeners


def resident_mb(pid: int) -> float:
    """Return the memory a process has, MB."""
    return int((Path("/proc") / str(pid) / "statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def processor_s(pid: int) -> float:
    """Return the processor time a process has used, s."""
    fields = (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    lines: list[str] = []
    with tempfile.TemporaryDirectory() as cache:
        start_s(cache)
        for what, kept in (("bytecode cached", cache), ("as found here", None)):
            found = [start_s(kept) for _ in range(3 if short else 10)]
            times, memories = [took for took, _ in found], [memory for _, memory in found]
            lines.append(
                f"{what:16} first heartbeat after {percentile(times, 0.5):.2f} s, worst {max(times):.2f} s "
                f"(bar {BAR_START_S}), {max(memories):.0f} MB resident (bar {BAR_MEMORY_MB:.0f})"
            )
        for model in ("kinematic", "dynamic", "rigid_body"):
            for instances in (1, 4):
                used, rate, memory = share(cache, model, instances, 3.0 if short else 10.0)
                bar = f" (bar {BAR_SHARE:.0%})" if instances == 1 else ""
                lines.append(
                    f"{model:10} × {instances}: {used:.1%} of a core{bar}, {rate:.1f} kB/s each, {memory:.0f} MB"
                )
    return lines
