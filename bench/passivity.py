"""Energy at the haptic port with delay, jitter, loss and a blackout, the passivity controller on and off."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from haptic_loop import LOOSE, Link, least_energy

from drivers.arm import Arm

DELAYS_S = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7)
LIMIT_J = -1e-3


def main(*, short: bool) -> Iterator[str]:
    """Yield the table: the least energy of the hand's account, over seeds and arms."""
    seeds, seconds = (1, 8.0) if short else (5, 20.0)
    yield f"least energy of the hand's account, {seeds} seeds x 2 arms x {seconds:.0f} s; bar: -1 mJ or more"
    yield "one-way delay    controller on    off"
    worst = 0.0
    for delay in DELAYS_S:
        link = Link(delay, jitter=0.5, loss=0.3, blackout=(4.0, 4.5))
        on, off = (_least(link, seconds, range(seeds), passivity=on) for on in (True, False))
        worst = min(worst, on)
        yield f"{1e3 * delay:8.0f} ms {1e3 * on:15.2f} mJ {1e3 * off:9.0f} mJ"
    yield f"worst with the controller: {1e3 * worst:.2f} mJ ({'holds' if worst >= LIMIT_J else 'VIOLATED'})"


def _least(link: Link, seconds: float, seeds: range, *, passivity: bool) -> float:
    return min(
        least_energy(link, passivity=passivity, seconds=seconds, seed=seed, arm=arm)
        for seed in seeds
        for arm in (Arm(), LOOSE)
    )
