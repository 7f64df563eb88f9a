"""The servo's pace on an emulated device, against a bare C loop on the same machine at the same time.

Everything runs: screen at 200 x 60, simulated vehicle, link, recorder, and the device's double on a pty. The C loop
(`bench/c/sleeper.c`) asks the kernel for the same rate at the same priority; what it is late, no program can help.
"""

from __future__ import annotations

import os
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from bench.rig import ROOT, Program
from groundstation.pilot.realtime import PRIORITY

SECONDS = {True: 10, False: 60}
BAR_TICKS, BAR_CPU, BAR_ORDINARY = 0.999, 0.30, 1.2
DEVICE = "emulated:falcon"
# Even root may not ask for real-time priority without this capability.
ORDINARY = ("setpriv", "--inh-caps=-sys_nice", "--bounding-set=-sys_nice")


def main(*, short: bool) -> Iterator[str]:
    """Yield the table, with real-time priority where it is granted, and without."""
    if shutil.which("gcc") is None:
        yield "skipped: there is no C compiler (gcc) to make the bare loop with"
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sleeper = folder / "sleeper"
        subprocess.run(["gcc", "-O2", "-o", sleeper, ROOT / "bench" / "c" / "sleeper.c"], check=True)
        yield "                        p50      p99  largest   ticks run   processor"
        for realtime in (True, False):
            yield from _compare(folder, sleeper, SECONDS[short], realtime=realtime)


def _compare(folder: Path, sleeper: Path, seconds: int, *, realtime: bool) -> Iterator[str]:
    under = () if realtime else ORDINARY
    program = Program("--sim", "--device", DEVICE, "--logs", str(folder), under=under)
    try:
        program.engage()
        if program.console.snapshot().servo.realtime != realtime:
            yield f"{'with' if realtime else 'without'} real-time priority: cannot be had on this machine, skipped"
            return
        pilot = program.pids()["pilot"]
        before, used = program.console.snapshot().servo, _processor_s(pilot)
        windows: list[tuple[float, float, float]] = []
        bare = subprocess.Popen(
            [sleeper, "1000", str(seconds), str(PRIORITY if realtime else 0)],
            stdout=subprocess.PIPE,
            text=True,
        )
        last_t = before.t
        while bare.poll() is None:
            report = program.until(lambda view, t=last_t: view.servo.t > t, 5, "a servo report").servo
            last_t = report.t
            windows.append((report.late_p50, report.late_p99, report.late_max))
        after = program.console.snapshot().servo
        share = (_processor_s(pilot) - used) / (after.t - before.t)
    finally:
        program.close()
    rows = [[float(word) for word in line.split()] for line in bare.stdout.read().splitlines()]
    ticks = (after.ticks - before.ticks) / ((after.t - before.t) * after.rate)
    ours = [statistics.median(column) * 1e6 for column in zip(*windows, strict=True)]
    theirs = [statistics.median(column) for column in list(zip(*rows, strict=True))[:3]]
    bare_ticks = sum(row[3] for row in rows) / sum(row[3] + row[4] for row in rows)
    bar = 1.0 if realtime else BAR_ORDINARY
    yield "with real-time priority" if realtime else "without"
    yield f"  servo, Python     {ours[0]:6.0f} {ours[1]:8.0f} {ours[2]:8.0f} us {ticks:9.3%} {share:10.1%}"
    yield f"  bare loop, C      {theirs[0]:6.0f} {theirs[1]:8.0f} {theirs[2]:8.0f} us {bare_ticks:9.3%}"
    ratio = ours[1] / theirs[1]
    yield f"  p99 {ratio:.2f} of C's (bar {bar}), processor {share:.0%} (bar {BAR_CPU:.0%})" + (
        f", ticks {ticks:.2%} (bar {BAR_TICKS:.1%})" if realtime else ""
    )


def _processor_s(pid: int) -> float:
    fields = (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
