"""From an urgent key to the command on its way to the vehicle, on each screen, with recorder and painting.

Measured outside the program: the key is what is typed into the terminal, the answer is the datagram with the change
of mode at the vehicle's port. The bar: 100 ms.
"""

from __future__ import annotations

import random
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from bench.rig import Program, Tap, percentile, vehicle

BAR_MS = 100.0
_HOLD, _SET_MODE = "\x1b[12~", 176
# Screens by the key that opens them and the one that leaves, as an xterm sends them: F7, F9, F12, help.
SCREENS = {"fly": ("", ""), "preflight": ("\x1b[18~", "\x1b"), "parameters": ("\x1b[20~", "\x1b"),
           "log": ("\x1b[24~", "\x1b"), "help": ("?", "\x1b")}  # fmt: skip
_LOOK_S, _WAIT_S, _REST_S = 1.0, 2.0, 0.3
_PRESSES, _FEW = 20, 4


def measured(presses: int) -> dict[str, list[float]]:
    """Return how long each press took, by screen, ms; infinite where nothing came of it."""
    with tempfile.TemporaryDirectory() as logs:
        tap = Tap()
        with vehicle(tap.vehicle_port):
            program = Program(
                "--connect", f"udpout://127.0.0.1:{tap.program_port}", "--logs", str(Path(logs))
            )
            try:
                program.engage()
                found: dict[str, list[float]] = {}
                for name, (opens, leaves) in SCREENS.items():
                    program.type(opens)
                    time.sleep(_LOOK_S)
                    # Help is left by an urgent key.
                    found[name] = [
                        _press(program, tap, opens if name == "help" else "") for _ in range(presses)
                    ]
                    program.type(leaves)
                    time.sleep(_LOOK_S)
                return found
            finally:
                program.close()
                tap.close()


def _press(program: Program, tap: Tap, opens: str) -> float:
    if opens:
        program.type(opens)
    time.sleep(_REST_S + random.uniform(0.0, 0.1))
    tap.commands.clear()
    pressed = time.monotonic()
    program.type(_HOLD)
    while time.monotonic() < pressed + _WAIT_S:
        for t, command in list(tap.commands):
            if command == _SET_MODE:
                return 1e3 * (t - pressed)
        time.sleep(0.002)
    return float("inf")


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    for name, late in measured(_FEW if short else _PRESSES).items():
        yield (
            f"{name:<11} p50 {percentile(late, 0.5):5.1f} ms, largest {max(late):5.1f} ms of {len(late)} "
            f"(bar {BAR_MS:g} ms)"
        )
