"""Steps per second of the rigid body with its controllers, in all its ways to run, beside other simulators.

All run on one core, in turns; what is compared is the median of the ratios within a turn. Steps are of 4 ms, and a
step of a simulator with a controller is one of both. RotorPy and gym-pybullet-drones fly their velocity control,
HyperDrone has none and takes motors. What a second is counted in is processor time.
"""

from __future__ import annotations

import json
import statistics
import subprocess
from collections.abc import Callable
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from bench.cpp.loop import BLOCK, CppLoop, NoCompilerError
from bench.peers.meter import Contest, Meter
from bench.peers.room import HERE, Room
from sim.airframe import MODELS, load_airframe
from sim.many.batch import Backend, Batch
from sim.many.lanes import law

DT = 0.004
START = (0.0, 0.0, 20.0, 0.0)
WANTED = (1.0, 0.5, 0.0, 0.3)
CALM = (0.0, 0.0, 0.0)
MANY = 100
PEERS = {
    "run_rotorpy.py": "requirements.txt", "run_gym.py": "requirements.txt", "run_hyperdrone.py": "requirements.txt",
}  # fmt: skip
PLAIN, ROWS, SINGLE, BATCH = "plain Python", "NumPy rows × {}", "numba", "numba × 1000"
CPP = f"C++ loop × 1024, {MANY} steps a call"


class Bar(NamedTuple):
    """Ours, theirs, and how many times as fast ours shall be at least."""

    ours: str
    theirs: str
    least: float


BARS = (
    Bar(PLAIN, "RotorPy", 30.0),
    Bar(PLAIN, "gym-pybullet-drones", 3.0),
    Bar(PLAIN, "gym-pybullet-drones, control every 4th step", 3.0),
    Bar(SINGLE, "HyperDrone", 2.0),
    Bar(f"{BATCH}, {MANY} steps a call", "HyperDrone × 1000", 5.0),
    Bar(f"{BATCH}, {MANY} steps a call", CPP, 0.5),
    Bar(ROWS.format(100), "RotorPy, torch × 100", 10.0),
    Bar(ROWS.format(1000), "RotorPy, torch × 1000", 10.0),
)


class Peer:
    """Another simulator in its own process and environment; waits while others are measured."""

    def __init__(self, room: Room, script: str) -> None:
        self._process = subprocess.Popen(
            [str(room.python), str(HERE / script)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env=room.environment(),
        )  # fmt: skip
        self.why = "" if self._answer() else self._last_words()

    def look(self) -> dict[str, float]:
        """Return the steps per second of each of its contests."""
        assert self._process.stdin
        print(file=self._process.stdin, flush=True)
        return json.loads(self._answer() or "{}")

    def close(self) -> None:
        """End it."""
        self._process.communicate()

    def _answer(self) -> str:
        assert self._process.stdout
        # Peers say other things, too.
        for line in self._process.stdout:
            if line.startswith(('["', '{"')):
                return line
        return ""

    def _last_words(self) -> str:
        words = self._process.communicate()[1].strip().splitlines()
        return next((line for line in reversed(words) if "Error" in line), words[-1] if words else "it ended")


def ours() -> tuple[list[Contest], list[str]]:
    """Return our contests, and what is left out and why."""
    contests = [Contest(PLAIN, 1, _plain())]
    contests += [Contest(ROWS.format(n), n, _batch(n, "numpy", 1)) for n in (100, 1000)]
    left_out: list[str] = []
    if find_spec("numba"):
        from sim.many.fast import Single

        single = Single(load_airframe("x500"), "rigid_body", DT)
        single.hover(START)
        single.v_ref[:] = WANTED
        contests += [
            Contest(SINGLE, 1, single.step),
            Contest("numba, 1000 steps a call", 1000, lambda: single.step(1000)),
            Contest(BATCH, 1000, _batch(1000, "numba", 1)),
            Contest(f"{BATCH}, {MANY} steps a call", 1000 * MANY, _batch(1000, "numba", MANY)),
        ]
    else:
        left_out.append("numba: not installed; the extra `fast` has it")
    try:
        contests += [
            Contest("C++ loop × 1024", 64 * BLOCK, _cpp(1)),
            Contest(CPP, 64 * BLOCK * MANY, _cpp(MANY)),
        ]
    except NoCompilerError as error:
        left_out.append(f"C++ loop: {error}")
    return contests, left_out


def _plain() -> Callable[[], None]:
    motion = MODELS["rigid_body"](load_airframe("x500"))
    p, v = START, (0.0, 0.0, 0.0, 0.0)

    def step() -> None:
        nonlocal p, v
        p, v = motion.step(p, v, WANTED, CALM, DT)

    for _ in range(500):
        step()
    return step


def _batch(n: int, backend: Backend, steps: int) -> Callable[[], None]:
    batch = Batch(load_airframe("x500"), "rigid_body", n, backend)
    batch.hover(START)
    v_ref, wind = np.tile(WANTED, (n, 1)), np.zeros((n, 3))
    return lambda: batch.step(v_ref, wind, DT, steps)


def _cpp(steps: int) -> Callable[[], None]:
    airframe = load_airframe("x500")
    rigid, n = law(airframe, "rigid_body"), 64 * BLOCK
    lanes = np.tile(np.array([rigid.hover(START, airframe)]).T, (1, n))
    v_ref, wind = np.tile(np.array([WANTED]).T, (1, n)), np.zeros((3, n))
    loop = CppLoop(lanes, v_ref, wind, rigid.constants(airframe, DT))
    return lambda: loop.step(steps)


def rounds(count: int) -> tuple[list[dict[str, float]], list[str]]:
    """Measure all in turns; return the steps per second of each turn, and what is left out and why."""
    contests, left_out = ours()
    room = Room()
    left_out += [f"the peers of {file}: {why}" for file, why in room.missing.items()]
    peers: list[Peer] = []
    for script, file in PEERS.items():
        if file in room.missing:
            continue
        peer = Peer(room, script)
        if peer.why:
            left_out.append(f"{script}: {peer.why}")
        else:
            peers.append(peer)
    meters = [Meter(contest) for contest in contests]
    found: list[dict[str, float]] = []
    for _ in range(count):
        turn = {meter.contest.name: meter.look() for meter in meters}
        for peer in peers:
            turn |= peer.look()
        found.append(turn)
    for peer in peers:
        peer.close()
    return found, left_out


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    found, left_out = rounds(3 if short else 9)
    lines = [f"{'':<46} {'steps/s':>12}"]
    lines += [f"{name:<46} {statistics.median(turn[name] for turn in found):>12,.0f}" for name in found[0]]
    for bar in BARS:
        if bar.ours in found[0] and bar.theirs in found[0]:
            ratio = statistics.median(turn[bar.ours] / turn[bar.theirs] for turn in found)
            met = "met" if ratio >= bar.least else "MISSED"
            lines.append(f"{ratio:7.1f} ×  {bar.ours} / {bar.theirs}   (bar {bar.least:g} ×, {met})")
    return lines + [f"not measured: {what}" for what in left_out]
