"""What benchmarks and flight tests stand on: the real program in a terminal, a vehicle on a tapped wire, a hand.

Nothing here reaches into the program: the hand is the device's socket, the tap is the vehicle's UDP port, and the
buttons are the same commands a screen sends.
"""

from __future__ import annotations

import contextlib
import os
import pty
import select
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

from drivers.stick import StickSender
from groundstation.bus import Bus
from groundstation.console import Console, Snapshot
from groundstation.messages import CommandKind, FlightMode, Phase
from groundstation.processes import free_port
from groundstation.run_folder import run_folder

ROOT = Path(__file__).resolve().parents[1]
SETPOINT_ID = 84
_COMMAND_LONG = (76).to_bytes(3, "little")
_FRAME = b"\x1b[?2026h"
ROLES = {
    "groundstation.recording.recorder": "recorder",
    "groundstation.vehicle.link": "link",
    "groundstation.pilot.servo": "pilot",
}


class Tap:
    """A UDP relay between program and vehicle that notes when setpoint frames pass and what they carry.

    Attributes:
        setpoints: (time, payload) of every datagram with a setpoint, on its way to the vehicle.
        commands: (time, command) of every COMMAND_LONG on its way to the vehicle.
        heard: (time, datagram) of all that the vehicle said.
        said: (time, datagram) of all that the program said.
        passes: Says of a datagram whether it passes, either way; all do at first.
    """

    def __init__(self) -> None:
        self._program = _bound()
        self._vehicle = _bound()
        self._peers: dict[socket.socket, object] = {}
        self._running = True
        self.passes: Callable[[bytes], bool] = lambda _: True
        self.setpoints: list[tuple[float, bytes]] = []
        self.commands: list[tuple[float, int]] = []
        self.heard: list[tuple[float, bytes]] = []
        self.said: list[tuple[float, bytes]] = []
        self.program_port = int(self._program.getsockname()[1])
        self.vehicle_port = int(self._vehicle.getsockname()[1])
        self._thread = threading.Thread(target=self._relay, daemon=True)
        self._thread.start()

    def inject(self, data: bytes) -> None:
        """Say something to the vehicle as if it came from the program's side."""
        self._vehicle.sendto(data, self._peers[self._vehicle])

    def say(self, data: bytes) -> None:
        """Say something to the program as if it came from the vehicle's side."""
        self._program.sendto(data, self._peers[self._program])

    def close(self) -> None:
        """End the relay."""
        self._running = False
        self._thread.join()
        self._program.close()
        self._vehicle.close()

    def _relay(self) -> None:
        other = {self._program: self._vehicle, self._vehicle: self._program}
        while self._running:
            for ready in select.select([self._program, self._vehicle], [], [], 0.1)[0]:
                data, peer = ready.recvfrom(65536)
                now = time.monotonic()
                self._peers[ready] = peer
                if ready is self._vehicle:
                    self.heard.append((now, data))
                else:
                    self.said.append((now, data))
                if not self.passes(data):
                    continue
                if ready is self._program and data[0] == 0xFD and data[7] == SETPOINT_ID:
                    self.setpoints.append((now, data[14 : 10 + data[1]].ljust(49, b"\0")))
                if ready is self._program and data[0] == 0xFD and data[7:10] == _COMMAND_LONG:
                    self.commands.append((now, int.from_bytes(data[38:40], "little")))
                if (to := self._peers.get(other[ready])) is not None:
                    with contextlib.suppress(OSError):
                        other[ready].sendto(data, to)


def _bound() -> socket.socket:
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.bind(("127.0.0.1", 0))
    return udp


class Hand:
    """Holds a software handle at a place, repeating itself at 100 Hz; `put` returns when it went out.

    Attributes:
        silent: It does not repeat itself.
    """

    def __init__(self, path: str) -> None:
        self._sender = StickSender(path)
        self._lock = threading.Lock()
        self._place, self._buttons = (0.0, 0.0, 0.0), 0
        self.silent = False
        self._running = True
        self._thread = threading.Thread(target=self._repeat, daemon=True)
        self._thread.start()

    def put(self, place: tuple[float, float, float], buttons: int = 0) -> float:
        """Move the handle, press its buttons (one bit each), and return the moment it was sent, monotonic s."""
        with self._lock:
            self._place, self._buttons = place, buttons
            now = time.monotonic()
            self._sender.send(place, 0.0, buttons, now)
        return now

    def close(self) -> None:
        """Let go."""
        self._running = False
        self._thread.join()
        self._sender.close()

    def _repeat(self) -> None:
        while self._running:
            with self._lock:
                if not self.silent:
                    self._sender.send(self._place, 0.0, self._buttons, time.monotonic())
            time.sleep(0.01)


class Program:
    """The real program in a pseudo-terminal, and its bus.

    Args:
        arguments: Its command line.
        columns, rows: Size of the terminal.
        under: Command that starts it, as `setpriv` does with fewer rights.
        watch: Is given all that the program writes.
        environment: Variables that it gets besides.

    Attributes:
        screen: The newest of what it wrote to the terminal.
        written: How much it wrote, bytes.
        frames: How many frames it painted since `count_frames`.
    """

    def __init__(
        self,
        *arguments: str,
        columns: int = 200,
        rows: int = 60,
        under: tuple[str, ...] = (),
        watch: Callable[[bytes], None] = lambda _: None,
        environment: dict[str, str] | None = None,
    ) -> None:
        self.started = time.monotonic()
        controller, terminal = pty.openpty()
        _resize(terminal, columns, rows)
        self.process = subprocess.Popen(
            [*under, sys.executable, "-m", "groundstation.cli", *arguments],
            stdin=terminal, stdout=terminal, stderr=terminal, cwd=ROOT, start_new_session=True,
            env=os.environ | {"TERM": "xterm-256color", "COLORTERM": "truecolor"} | (environment or {}),
        )  # fmt: skip
        os.close(terminal)
        self._controller = controller
        self._closed, self._watch = False, watch
        self._reader = threading.Thread(target=self._drain, daemon=True)
        self.screen = bytearray()
        self.written = self.frames = 0
        self._reader.start()
        self.bus = self._join()
        self.console = Console(self.bus, "bench")

    def type(self, keys: str) -> None:
        """Type keys into the terminal."""
        os.write(self._controller, keys.encode())

    def count_frames(self) -> None:
        """Say that this terminal takes whole frames (mode 2026), so that each is marked."""
        self.type("\x1b[?2026;2$y")

    def until(self, condition, within_s: float, what: str) -> Snapshot:
        """Wait until a snapshot meets a condition.

        Raises:
            SystemExit: It did not in time.
        """
        deadline = time.monotonic() + within_s
        while time.monotonic() < deadline:
            view = self.console.snapshot()
            if condition(view):
                return view
            if self.process.poll() is not None:
                raise SystemExit(f"the program ended ({self.process.returncode}) before: {what}")
            time.sleep(0.005)
        words = [event.text.decode(errors="replace") for event in self.console.snapshot().events][-8:]
        raise SystemExit(f"within {within_s} s it did not happen: {what}; last events: {words}")

    def engage(self) -> None:
        """Arm, take off, and couple the hand."""
        self.until(
            lambda view: view.status and view.status.connected and view.status.health & 64, 30, "armable"
        )
        for kind, condition, what in (
            (CommandKind.ARM, lambda view: view.status.armed, "armed"),
            (CommandKind.TAKEOFF, hovers, "hovering"),
            (CommandKind.ENGAGE, lambda view: view.pilot and view.pilot.phase == Phase.ENGAGED, "engaged"),
        ):
            self.console.command(kind)
            self.until(condition, 20, what)

    def pids(self) -> dict[str, int]:
        """Return the processes of the run by the module or role they run."""
        found: dict[str, int] = {}
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError, ValueError):
                if int((folder / "stat").read_text().rpartition(")")[2].split()[1]) == self.process.pid:
                    words = (folder / "cmdline").read_bytes().decode().split("\0")
                    module = words[words.index("-m") + 1]
                    found[ROLES.get(module, module)] = int(folder.name)
        return found

    def hang_up(self) -> None:
        """Take the terminal away."""
        self._closed = True
        self._reader.join(1.0)
        os.close(self._controller)

    def close(self) -> None:
        """End the program and leave its bus."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(30)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self.bus.close()
        if not self._closed:
            self.hang_up()

    def _join(self) -> Bus:
        """Find the program's bus by the run folder that carries its process id."""
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            prefix = run_folder(f"{self.process.pid}-").name
            for folder in Path(tempfile.gettempdir()).glob(f"{prefix}*/run.json"):
                return Bus(folder.parent.name.partition("-")[2], "bench")
            time.sleep(0.005)
        raise SystemExit("the program did not start:\n" + self.screen.decode(errors="replace")[-2000:])

    def _drain(self) -> None:
        while not self._closed:
            if not select.select([self._controller], [], [], 0.1)[0]:
                continue
            try:
                news = os.read(self._controller, 65536)
                self.written += len(news)
                self.frames += news.count(_FRAME)
                self.screen += news
                self._watch(news)
            except OSError:
                # Nobody has the terminal open now; somebody may again.
                time.sleep(0.02)
            del self.screen[:-100_000]


def hovers(view: Snapshot) -> bool:
    """Say whether the vehicle has taken off and stands in the air."""
    return bool(
        view.status
        and view.vehicle
        and view.status.mode == FlightMode.HOLD
        and view.vehicle.position[2] > 1.0
        and abs(view.vehicle.velocity[2]) < 0.1
    )


def _resize(terminal: int, columns: int, rows: int) -> None:
    import fcntl
    import struct
    import termios

    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))


@contextlib.contextmanager
def vehicle(port: int, *options: str):
    """Run a simulated vehicle that sends to a local port."""
    command = [sys.executable, "-m", "sim", "--connect", f"udpout://127.0.0.1:{port}", "--quiet", *options]
    process = subprocess.Popen(command, cwd=ROOT)
    try:
        yield process
    finally:
        process.terminate()
        process.wait(10)


def percentile(values: list[float], share: float) -> float:
    """Return the value below which `share` (0 to 1) of all lie."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


__all__ = ["ROOT", "Hand", "Program", "Tap", "free_port", "percentile", "vehicle"]
