"""What the screen costs while it flies: its share of a core at 200×60 and 30 Hz, and ticks the servo lost to it.

The paper's mission on the simulated vehicle, in a pseudo-terminal that takes every byte at once; the stick is moved
all the time, so that every instrument changes. Beside it, in the same run, the same flight without a screen. And a
flight by an emulated Falcon, whose screen is stopped for a second: what leaves for the vehicle meanwhile.
"""

from __future__ import annotations

import math
import os
import signal
import tempfile
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from bench.rig import ROOT, Hand, Program, Tap, vehicle
from groundstation.console import Snapshot
from groundstation.messages import Phase

BAR_SHARE = 30.0
COLUMNS, ROWS = 200, 60
# The longest that a flight without a screen stays engaged is some 30 s.
LONG_S, SHORT_S = 20.0, 8.0
FROZEN_S = 1.0
_WARM_S = 6.0
_TRIES = 4
# Arrow keys: forward, left, back, right, and the centre.
_MOVES = ("\x1b[A", "\x1b[D", "\x1b[B", "\x1b[C", " ")
VIEWS = ("above", "side", "chase", "first person")


class Cost(NamedTuple):
    """What a screen cost.

    Attributes:
        share: Of a core, %.
        frames: Painted a second, Hz.
        rate: To the terminal, kB/s.
        missed: Ticks that the servo did not run, of `ticks`.
    """

    share: float
    frames: float
    rate: float
    missed: int
    ticks: int


class Second(NamedTuple):
    """What left for the vehicle in a second.

    Attributes:
        setpoints: How many.
        gap: The longest without one, s.
        missed: Ticks that the servo did not run.
        engaged: The hand was coupled at its end.
    """

    setpoints: int
    gap: float
    missed: int
    engaged: bool


def on_screen(view: int, seconds: float) -> Cost:
    """Fly with the screen in one of its views, by its number in `VIEWS`, and measure for a while, s."""
    with tempfile.TemporaryDirectory() as logs:
        program = Program("--sim", "--mission", "paper", "--logs", logs, columns=COLUMNS, rows=ROWS)
        try:
            program.engage()
            program.count_frames()
            program.type("v" * view)
            _steer(program, _WARM_S)
            used, written, frames = cpu_s(program.process.pid), program.written, program.frames
            before, began = program.console.snapshot(), time.monotonic()
            _steer(program, seconds)
            wall = time.monotonic() - began
            share = 100.0 * (cpu_s(program.process.pid) - used) / wall
            painted, kilobytes = (program.frames - frames) / wall, (program.written - written) / 1000.0 / wall
            return Cost(share, painted, kilobytes, *_ticks(before, program.console.snapshot()))
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


def freeze() -> tuple[Second, Second]:
    """Fly by an emulated Falcon; return the second before its screen is stopped, and the one in which it stands.

    On a machine that is too busy the emulator falls silent, and the pilot lets go of it: then it is flown again.

    Raises:
        SystemExit: It has fallen silent each time.
    """
    for _ in range(_TRIES):
        before, during = _frozen()
        if before.engaged:
            return before, during
    raise SystemExit("the emulated Falcon falls silent: the machine is too busy for this bench")


def _frozen() -> tuple[Second, Second]:
    """Fly once."""
    mission = str(ROOT / "missions" / "free.toml")
    with tempfile.TemporaryDirectory() as folder:
        socket = str(Path(folder) / "hand.sock")
        hand, tap = Hand(socket), Tap()
        with vehicle(tap.vehicle_port, "--mission", mission):
            program = Program(
                "--connect", f"udpout://127.0.0.1:{tap.program_port}", "--mission", mission,
                "--device", f"emulated:falcon@{socket}", "--logs", str(Path(folder) / "logs"),
            )  # fmt: skip
            try:
                program.until(lambda view: view.device and view.device.homed, 20, "the Falcon is homed")
                program.engage()
                _stir(hand, _WARM_S)
                before = _second(program, tap, hand)
                os.kill(program.process.pid, signal.SIGSTOP)
                try:
                    return before, _second(program, tap, hand)
                finally:
                    os.kill(program.process.pid, signal.SIGCONT)
            finally:
                program.close()
                hand.close()
                tap.close()


def cpu_s(pid: int) -> float:
    """Return the processor time that a process has used, s."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _second(program: Program, tap: Tap, hand: Hand) -> Second:
    """Move the hand for as long as a screen stands still, and look at what left for the vehicle."""
    before, began = program.console.snapshot(), time.monotonic()
    _stir(hand, FROZEN_S)
    ended, after = time.monotonic(), program.console.snapshot()
    times = [began, *(t for t, _ in list(tap.setpoints) if began <= t <= ended), ended]
    assert after.pilot is not None
    gap = max(later - earlier for earlier, later in pairwise(times))
    return Second(len(times) - 2, gap, _ticks(before, after)[0], after.pilot.phase == Phase.ENGAGED)


def _stir(hand: Hand, seconds: float) -> None:
    """Move the handle in circles for a while."""
    began = time.monotonic()
    while (elapsed := time.monotonic() - began) < seconds:
        hand.put((0.02 * math.sin(4.0 * elapsed), 0.02 * math.cos(4.0 * elapsed), 0.0))
        time.sleep(0.01)


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
        if short and number not in {0, len(VIEWS) - 1}:
            continue
        cost = on_screen(number, seconds)
        yield (
            f"{view:<13} {cost.share:4.1f} % of a core (bar {BAR_SHARE:g} %) at {cost.frames:4.1f} Hz, "
            f"{cost.rate:4.0f} kB/s; servo missed {cost.missed} of {cost.ticks} ticks"
        )
    missed, ticks = without(seconds)
    yield f"without       servo missed {missed} of {ticks} ticks"
    for name, second in zip(("turning", "stopped"), freeze(), strict=True):
        yield (
            f"screen {name}: {second.setpoints} setpoints in {FROZEN_S:g} s, longest gap {1e3 * second.gap:.0f} ms, "
            f"servo missed {second.missed} ticks, hand {'coupled' if second.engaged else 'UNCOUPLED'}"
        )
