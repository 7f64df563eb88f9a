"""What is left of a flight when one of its processes is killed (SIGKILL) at a random moment: how much is missing.

Whole flights of the paper's mission, each in real time; which process and when is drawn from a seed. A handle's row
that was published before the kill and is not in the recording is missing.
"""

from __future__ import annotations

import datetime
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from groundstation.recording import schema
from groundstation.review.flight import Flight

BAR_S = 1.0
FULL, SHORT = 50, 5
# Before the first second is over there is nothing that must be kept.
_EARLIEST_S, _LATEST_S = 1.5, 18.0
_GOES_ON_S, _END_S = 2.0, 30.0
_MODULES = {
    "recorder": "groundstation.recording.recorder",
    "link": "groundstation.vehicle.link",
    "pilot": "groundstation.pilot.servo",
    "sim": "sim",
}
_FLIGHT = ("--sim", "--headless", "--mission", "paper")
_VICTIMS = (*_MODULES, "program")


def missing_after(victim: str, moment: float) -> float:
    """Kill a process of a flight and return what its recording misses, s.

    Args:
        victim: One of the roles, or the program itself.
        moment: After the recording began, s.
    """
    with tempfile.TemporaryDirectory() as folder:
        program = subprocess.Popen(
            [sys.executable, "-m", "groundstation.cli", *_FLIGHT, "--logs", folder],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        while not (found := list(Path(folder).glob("*.rrd"))):
            time.sleep(0.02)
        time.sleep(moment)
        processes = {role: _pid(program.pid, module) for role, module in _MODULES.items()} | {
            "program": program.pid
        }
        if 0 in processes.values():
            raise SystemExit(f"the flight ended by itself before: {program.communicate()[1]}")
        os.kill(processes[victim], signal.SIGKILL)
        killed = time.time()
        time.sleep(_GOES_ON_S)
        program.terminate()
        program.communicate(timeout=_END_S)
        while Path(f"/proc/{processes['recorder']}").exists():
            time.sleep(0.02)
        flight = Flight(found[0])
        began = datetime.datetime.fromisoformat(str(flight.properties()["started"])).timestamp()
        return killed - began - float(flight.series(schema.HANDLE_FORCE).t[-1])


def _pid(parent: int, module: str) -> int:
    """Return the process of a module that a program has started, or 0."""
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            above = (folder / "stat").read_text().rpartition(")")[2].split()[1]
            words = (folder / "cmdline").read_bytes().decode().split("\0")
        except OSError:
            continue
        if int(above) == parent and "-m" in words and words[words.index("-m") + 1] == module:
            return int(folder.name)
    return 0


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    draw = random.Random(0)
    missing: dict[str, list[float]] = {victim: [] for victim in _VICTIMS}
    for number in range(SHORT if short else FULL):
        victim = _VICTIMS[number % len(_VICTIMS)]
        missing[victim].append(missing_after(victim, draw.uniform(_EARLIEST_S, _LATEST_S)))
    for victim, seconds in missing.items():
        worst = f"missing at most {max(seconds):6.3f} s (≤ {BAR_S:g})"
        yield f"{victim:<9} killed {len(seconds):2} times, every recording opens; {worst}"
