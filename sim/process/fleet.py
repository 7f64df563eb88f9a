"""The loop of the process: all vehicles step together, at the pace of a clock, until somebody ends it."""

from __future__ import annotations

import ctypes
import gc
import os
import signal
import time
from collections.abc import Sequence
from types import FrameType

from sim.process.pacing import Pacer
from sim.process.status_line import StatusLine
from sim.process.vehicle import Vehicle

STEP_S = 0.004
_LOOK_S = 0.1
_MOST_TICKS = 250
_STATUS_S = 0.5


class Ending:
    """Knows when to end: on SIGTERM, SIGINT or SIGHUP (unless under nohup), and with the parent where asked to.

    Args:
        with_parent: End when the process that started this one is gone.
    """

    def __init__(self, *, with_parent: bool) -> None:
        self._parent = os.getppid() if with_parent else None
        self.told = False
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            if number != signal.SIGHUP or signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._end)

    def orphaned(self) -> bool:
        """Say whether the parent is gone."""
        return self._parent is not None and os.getppid() != self._parent

    def _end(self, _number: int, _frame: FrameType | None) -> None:
        self.told = True


def run(vehicles: Sequence[Vehicle], speed: float, ending: Ending, status: StatusLine | None) -> None:
    """Step, tell and wait, until the end.

    Args:
        vehicles: All that fly.
        speed: Times real time.
        ending: When to end.
        status: Where to tell how they are, if anywhere.
    """
    gc.collect()
    gc.freeze()
    _give_memory_back()
    pacer = Pacer(STEP_S / speed, time.monotonic, time.sleep)
    every = max(1, min(_MOST_TICKS, round(_LOOK_S * speed / STEP_S)))
    told_t, told_tick, tick = time.monotonic(), 0, 0
    if status:
        status.show(vehicles, speed, None)
    while not ending.told:
        for vehicle in vehicles:
            vehicle.step(STEP_S)
        tick += 1
        if tick % every == 0:
            if ending.orphaned():
                break
            now = time.monotonic()
            if status and now - told_t >= _STATUS_S:
                status.show(vehicles, speed, (tick - told_tick) * STEP_S / (now - told_t))
                told_t, told_tick = now, tick
        pacer.wait()
    if status:
        status.end()


def _give_memory_back() -> None:
    """Return what starting left free to the system: 50 MB where Python has to compile MAVLink's dialect first."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
