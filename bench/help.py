"""Processor time of `groundstation --help`: the bar is 0.3 s."""

from __future__ import annotations

import resource
import subprocess
import sys

from bench.rig import ROOT, percentile

BAR_S = 0.3


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    found: list[float] = []
    for _ in range(3 if short else 10):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-m", "groundstation.cli", "--help"],
            stdout=subprocess.DEVNULL,
            cwd=ROOT,
            check=True,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return [f"median {percentile(found, 0.5):.3f} s of processor time   (bar {BAR_S} s)"]
