"""The processes of a run, in one table: started together, watched, and ended in order.

The screen (or the headless flight) is the fifth process and holds the `Supervisor`. A process that dies or falls
silent is told once, in words. Pilot and link notice each other's death by themselves; whichever other process dies,
the supervisor has the pilot let go, so that the vehicle holds.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from groundstation.bus import Bus
from groundstation.conditions import Conditions
from groundstation.failsafe import BY_FAULT, Action, Fault, Who, first, rows
from groundstation.messages import COMMAND, HEARTBEAT, Command, CommandKind, Severity
from groundstation.run import Run, write_run
from groundstation.run_folder import Stay, run_folder, sweep
from groundstation.shown import shown

SILENT_S = 1.0
_STARTING_S = 15.0
_END_S = {"recorder": 20.0}
_END_USUAL_S = 3.0
_DEATHS = rows(Who.SUPERVISOR, Action.RELEASE)
_STALLED = BY_FAULT[Fault.PROCESS_STALLED]


class State(StrEnum):
    """How a process is."""

    STARTING = "starting"
    RUNNING = "running"
    SILENT = "silent"
    ENDED = "ended"


@dataclass(frozen=True)
class Process:
    """A row of the table.

    Attributes:
        role: Its name.
        command: What to run.
        beats: It sends heartbeats on the bus; one that does not is only watched for its end.
    """

    role: str
    command: tuple[str, ...]
    beats: bool = True


def table(run: Run, run_file: Path, sim_options: tuple[str, ...] = ()) -> tuple[Process, ...]:
    """Return the processes of a run in the order they are started; they are ended in the reverse order.

    Args:
        run: The run.
        run_file: Where its children read it.
        sim_options: Further options for the simulated vehicle, where there is one.
    """

    def child(role: str, module: str) -> Process:
        return Process(role, (sys.executable, "-m", module, str(run_file)))

    ours = (
        child("recorder", "groundstation.recording.recorder"),
        child("link", "groundstation.vehicle.link"),
        child("pilot", "groundstation.pilot.servo"),
    )
    if not run.simulated:
        return ours
    mission = ("--mission", run.mission_path) if run.mission_path else ()
    port = run.url.rpartition(":")[2]
    simulator = (sys.executable, "-m", "sim", "--connect", f"udpout://127.0.0.1:{port}")
    return (
        Process("sim", (*simulator, "--quiet", "--with-parent", *mission, *sim_options), beats=False),
        *ours,
    )


@dataclass(slots=True)
class _Watched:
    process: Process
    popen: subprocess.Popen[bytes]
    log: Path
    started: float
    beat_t: float = 0.0
    state: State = State.STARTING


class Supervisor:
    """Starts, watches and ends the processes of a run.

    Args:
        run: The run.
        processes: From `table`.
        bus: Where heartbeats come from and deaths are told.
        clock: Monotonic seconds.
    """

    def __init__(
        self, run: Run, processes: tuple[Process, ...], bus: Bus, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._run = run
        self._bus = bus
        self._clock = clock
        self._heartbeats = bus.subscriber(HEARTBEAT)
        self._commands = bus.publisher(COMMAND)
        self._watched = [self._start(process) for process in processes]

    def poll(self) -> list[str]:
        """Look at every process; tell of each that has newly died or fallen silent, and return the deaths."""
        now = self._clock()
        beats = {beat.role.decode(): beat.t for beat in self._heartbeats.drain()}
        deaths: list[str] = []
        ended: set[str] = set()
        for watched in self._watched:
            if sentence := self._look(watched, beats, now):
                self._bus.event(Severity.ALARM, sentence)
                if watched.state is State.ENDED:
                    deaths.append(sentence)
                    ended.add(watched.process.role)
        if first(_DEATHS, Conditions(ended=frozenset(ended)), self._run.settings.safety):
            self._commands.send(Command(t=now, kind=int(CommandKind.DISENGAGE), source=b"supervisor"))
        return deaths

    def states(self) -> Mapping[str, State]:
        """Return how each process was when last looked at."""
        return {watched.process.role: watched.state for watched in self._watched}

    def stop(self) -> None:
        """End all processes, the vehicle's last, and sweep what they shared."""
        for watched in reversed(self._watched):
            if watched.popen.poll() is None:
                # A stopped process cannot hear SIGTERM before it goes on.
                with contextlib.suppress(ProcessLookupError):
                    watched.popen.send_signal(signal.SIGCONT)
                watched.popen.terminate()
            try:
                watched.popen.wait(_END_S.get(watched.process.role, _END_USUAL_S))
            except subprocess.TimeoutExpired:
                watched.popen.kill()
                watched.popen.wait()
            watched.state = State.ENDED

    def _start(self, process: Process) -> _Watched:
        log = run_folder(self._run.run_id) / f"{process.role}.log"
        with log.open("wb") as output:
            # A session of its own: Ctrl-C in the terminal is the supervisor's to answer, in order.
            popen = subprocess.Popen(
                process.command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
        return _Watched(process, popen, log, self._clock())

    def _look(self, watched: _Watched, beats: Mapping[str, float], now: float) -> str:
        role = watched.process.role
        code = watched.popen.poll()
        if code is not None:
            if watched.state is State.ENDED:
                return ""
            watched.state = State.ENDED
            # Who is killed has no say; what it said last is not why.
            words = _last_words(watched.log) if code >= 0 else ""
            return f"The {role} process has died ({_cause(code)}){words}."
        watched.beat_t = beats.get(role, watched.beat_t)
        if not watched.process.beats or now - watched.beat_t <= SILENT_S:
            watched.state = State.RUNNING
            return ""
        if watched.state is State.RUNNING or (
            watched.state is State.STARTING and now - watched.started > _STARTING_S
        ):
            watched.state = State.SILENT
            return f"The {role} process {_STALLED.words}."
        return ""


def free_port() -> int:
    """Return a UDP port on loopback that nobody uses now."""
    import socket

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextlib.contextmanager
def running(run: Run, role: str, sim_options: tuple[str, ...] = ()) -> Generator[tuple[Bus, Supervisor]]:
    """Run a run: yield the bus and the supervisor, and leave nothing behind however the block ends."""
    run_file = write_run(run)
    stay = Stay(run.run_id)
    bus = Bus(run.run_id, role)
    supervisor = Supervisor(run, table(run, run_file, sim_options), bus)
    try:
        yield bus, supervisor
    finally:
        supervisor.stop()
        bus.close()
        stay.end()
        sweep(run.run_id)


def _cause(code: int) -> str:
    return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


def _last_words(log: Path) -> str:
    """Return the last line a process left, as a clause; it is nearly always the reason."""
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - 2_000), os.SEEK_SET)
            lines = file.read().decode(errors="replace").split("\n")
    except OSError:
        return ""
    words = next((line.strip() for line in reversed(lines) if line.strip()), "")
    return f": {shown(words.rstrip('.'))}" if words else ""
