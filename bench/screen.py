"""What the screen costs while it flies: its share of a core at 200×60 and 30 Hz, and ticks the servo lost to it.

The paper's mission on the simulated vehicle, in a pseudo-terminal that takes every byte at once; the stick is moved
all the time, so that every instrument changes. Beside it, in the same run, the same flight without a screen.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from bench.rig import Program
from groundstation.console import Snapshot
from groundstation.messages import Phase

BAR_SHARE = 30.0
COLUMNS, ROWS = 200, 60
# The longest that a flight without a screen stays engaged is some 30 s.
LONG_S, SHORT_S = 20.0, 8.0
_WARM_S = 3.0
# Arrow keys: forward, left, back, right, and the centre.
_MOVES = ("\x1b[A", "\x1b[D", "\x1b[B", "\x1b[C", " ")
VIEWS = ("top", "side", "chase", "first person")


def on_screen(view: int, seconds: float) -> tuple[float, float, int, int]:
    """Fly with the screen in one of its views.

    Args:
        view: Number in `VIEWS`.
        seconds: Measured.

    Returns:
        Share of a core, %; kilobytes a second to the terminal; ticks missed and run.
    """
    with tempfile.TemporaryDirectory() as logs:
        program = Program("--sim", "--mission", "paper", "--logs", logs, columns=COLUMNS, rows=ROWS)
        try:
            program.engage()
            program.type("v" * view)
            _steer(program, _WARM_S)
            used, written, before = cpu_s(program.process.pid), program.written, program.console.snapshot()
            began = time.monotonic()
            _steer(program, seconds)
            wall = time.monotonic() - began
            share = 100.0 * (cpu_s(program.process.pid) - used) / wall
            return (
                share,
                (program.written - written) / 1000.0 / wall,
                *_ticks(before, program.console.snapshot()),
            )
        finally:
            program.close()


def without(seconds: float) -> tuple[int, int]:
    """Fly without a screen; return ticks missed and run."""
    with tempfile.TemporaryDirectory() as logs:
        program = Program("--sim", "--headless", "--mission", "paper", "--logs", logs)
        try:
            program.until(
                lambda view: view.pilot and view.pilot.phase == Phase.ENGAGED and view.servo, 40, "engaged"
            )
            before = program.console.snapshot()
            time.sleep(seconds)
            return _ticks(before, program.console.snapshot())
        finally:
            program.close()


def cpu_s(pid: int) -> float:
    """Return the processor time that a process has used, s."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _steer(program: Program, seconds: float) -> None:
    """Move the stick for a while."""
    end = time.monotonic() + seconds
    turn = 0
    while time.monotonic() < end:
        program.type(_MOVES[turn % len(_MOVES)])
        turn += 1
        time.sleep(0.5)


def _ticks(before: Snapshot, after: Snapshot) -> tuple[int, int]:
    assert before.servo is not None
    assert after.servo is not None
    return after.servo.missed - before.servo.missed, after.servo.ticks - before.servo.ticks


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    seconds = SHORT_S if short else LONG_S
    for number, view in enumerate(VIEWS):
        if short and number not in (0, len(VIEWS) - 1):
            continue
        share, rate, missed, ticks = on_screen(number, seconds)
        yield (
            f"{view:<13} {share:4.1f} % of a core (bar {BAR_SHARE:g} %), {rate:4.0f} kB/s; "
            f"servo missed {missed} of {ticks} ticks ({100.0 * missed / max(ticks, 1):.2f} %)"
        )
    missed, ticks = without(seconds)
    yield f"without       servo missed {missed} of {ticks} ticks ({100.0 * missed / max(ticks, 1):.2f} %)"
