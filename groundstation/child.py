"""What every process of a run begins with and ends by: its run, its bus, and a lifeline to its supervisor."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

from groundstation.bus import Bus
from groundstation.failsafe import BY_FAULT, Fault
from groundstation.messages import Severity
from groundstation.run import Run, read_run
from groundstation.run_folder import Stay, sweep
from groundstation.terminal import give_back

HEARTBEAT_S = 0.1
_SCREEN_DEAD = BY_FAULT[Fault.SCREEN_DEAD]


class Lifeline:
    """Holds until the process is told to end or its supervisor is gone; beats the heart meanwhile.

    Args:
        bus: Where heartbeats go.
        clock: Monotonic seconds.
    """

    def __init__(self, bus: Bus, clock: Callable[[], float] = time.monotonic) -> None:
        self._bus = bus
        self._clock = clock
        self._parent = os.getppid()
        self._next_beat = 0.0
        self._ended = False
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            signal.signal(number, self._end)

    def holds(self) -> bool:
        """Say whether to go on. Call it every turn of the loop; most calls only read the clock."""
        now = self._clock()
        if now >= self._next_beat:
            self._next_beat = now + HEARTBEAT_S
            if os.getppid() != self._parent and not self._ended:
                self._bus.event(_SCREEN_DEAD.severity, _SCREEN_DEAD.words)
                self._ended = True
            self._bus.heartbeat()
        return not self._ended

    def _end(self, _number: int, _frame: object) -> None:
        self._ended = True


def run_child(role: str, body: Callable[[Run, Bus, Lifeline], None]) -> None:
    """Run one process: `python -m MODULE RUN_FILE`.

    An error that a user can mend arrives as `SystemExit` with a sentence, which becomes an event.

    Args:
        role: The process's name in the table, in events and heartbeats.
        body: Its work; returns when the lifeline no longer holds.
    """
    run = read_run(Path(sys.argv[1]))
    stay = Stay(run.run_id)
    bus = Bus(run.run_id, role)
    try:
        body(run, bus, Lifeline(bus))
    except SystemExit as end:
        if isinstance(end.code, str):
            bus.event(Severity.ALARM, end.code)
        raise
    finally:
        bus.close()
        if stay.end():
            # The supervisor, which else is the last, was killed.
            sweep(run.run_id)
            give_back(run.terminal)
