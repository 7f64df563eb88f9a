"""The paper's mission flown headless: target, collisions, final error, and how many servo ticks ran."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile

from bench.rig import ROOT

BAR_ERROR_M, BAR_TICKS = 0.2, 0.99


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    lines: list[str] = []
    for seed in range(1 if short else 5):
        with tempfile.TemporaryDirectory() as logs:
            command = [sys.executable, "-m", "groundstation.cli", "--sim", "--headless", "--mission", "paper"]
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            done = subprocess.run(
                [*command, "--json", "--seed", str(seed), "--logs", logs],
                cwd=ROOT, capture_output=True, text=True, check=False,
            )  # fmt: skip
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if not done.stdout:
            lines.append(f"seed {seed}: {done.stderr.strip()}")
            continue
        found = json.loads(done.stdout)
        servo = found["servo"]
        share = servo["ticks"] / (servo["ticks"] + servo["missed"])
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        lines.append(
            f"seed {seed}: {'completed' if found['completed'] else found['shortcomings']}, "
            f"{found['collisions']} collisions, final error {found['final_error_m']} m (bar {BAR_ERROR_M}), "
            f"RMS {found['rms_error_m']} m, {share:.2%} of ticks (bar {BAR_TICKS:.0%}), "
            f"late {servo['late_p50_us']:.0f} / {servo['late_p99_us']:.0f} µs, {found['duration_s']} s flown, "
            f"{seconds:.1f} s of processor time"
        )
    return lines
