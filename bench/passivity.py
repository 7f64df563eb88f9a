"""Energy at the haptic port, and what the hand feels, with delay, jitter, loss and a blackout, in every mode."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from statistics import fmean
from timeit import repeat

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from haptic_loop import DEVICE, DT, LOOSE, HapticRun, Link, Mode, haptic_run

from drivers.arm import Arm
from groundstation.pilot.passivity.choice import passivity_named
from groundstation.pilot.passivity.port import Port

DELAYS_S = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7)
MODES: tuple[Mode, ...] = ("observer", "wave", "tank", "off")
ARMS = (Arm(), LOOSE)
LIMIT_J = -1e-3


def main(*, short: bool) -> Iterator[str]:
    """Yield the tables: the least energy of the hand's account, over seeds and arms, and what was felt."""
    seeds, seconds = (1, 8.0) if short else (3, 20.0)
    yield f"{seeds} seeds x {len(ARMS)} arms x {seconds:.0f} s; 50 % jitter, 30 % loss, a blackout of 0.5 s"
    runs = {delay: _runs(delay, range(seeds), seconds) for delay in DELAYS_S}
    yield "least energy of the hand's account, mJ; bar: -1 or more"
    yield _row("one-way delay", MODES)
    for delay, by_mode in runs.items():
        yield _row(f"{1e3 * delay:.0f} ms", [f"{1e3 * _least(by_mode[mode]):.2f}" for mode in MODES])
    worst = min(_least(by_mode[mode]) for by_mode in runs.values() for mode in MODES if mode != "off")
    yield f"worst but off: {1e3 * worst:.2f} mJ ({'holds' if worst >= LIMIT_J else 'VIOLATED'})"
    yield "share of equation (5)'s force that is felt while the hand sweeps / while it rests and gives way"
    yield _row("one-way delay", MODES)
    for delay, by_mode in runs.items():
        yield _row(f"{1e3 * delay:.0f} ms", [_felt(by_mode[mode]) for mode in MODES])
    yield _row("us a tick", [f"{_cost(mode):.1f}" for mode in MODES])


def _runs(delay: float, seeds: range, seconds: float) -> dict[Mode, list[HapticRun]]:
    link = Link(delay, jitter=0.5, loss=0.3, blackout=(4.0, 4.5))
    return {
        mode: [
            haptic_run(link, passivity=mode, seconds=seconds, seed=seed, arm=arm)
            for seed in seeds
            for arm in ARMS
        ]
        for mode in MODES
    }


def _row(head: str, cells: list[str] | tuple[str, ...]) -> str:
    return f"{head:<14}" + "".join(f"{cell:>14}" for cell in cells)


def _least(runs: list[HapticRun]) -> float:
    return min(run.least_energy for run in runs)


def _felt(runs: list[HapticRun]) -> str:
    moving, resting = fmean(run.felt_moving for run in runs), fmean(run.felt_resting for run in runs)
    return f"{moving:.2f} / {resting:.2f}"


def _cost(mode: Mode) -> float:
    """Return what a tick costs, us: observed and rendered, with little on the account."""
    passivity, port, rounds = passivity_named(mode, DEVICE), Port(), 10_000

    def tick() -> None:
        seen = passivity.observed(port, (1e-3, 2e-3, 0.0))
        passivity.rendered(seen, (3.0, 1.0, 0.0), (0.1, 0.02, 0.0), DT, 0.3)

    return 1e6 * min(repeat(tick, number=rounds, repeat=5)) / rounds
