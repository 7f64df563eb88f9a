"""From a step of the handle to the first datagram that carries it, with screen and recorder running.

Measured outside the program: the step is the datagram at the device's socket, the answer is the datagram at the
vehicle's port. The bar: p50 ≤ 12 ms and p99 ≤ 25 ms at 50 Hz; of that 10 ms p50 and 20 ms p99 are the wait for
the next setpoint, which no program can shorten.
"""

from __future__ import annotations

import math
import random
import struct
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from bench.rig import Hand, Program, Tap, percentile, vehicle

BAR_P50_MS, BAR_P99_MS = 12.0, 25.0
# Wide limits: the step itself shall reach the wire, not the first thousandth of a jerk-limited ramp.
SETTINGS = (
    "[limits]\nacceleration = 1000.0\njerk = 1000.0\nyaw_acceleration = 1000.0\n[mapping]\nframe = 'world'\n"
)
CALM = 'schema = 1\nname = "calm"\ntitle = "Calm air, ideal vehicle"\n[vehicle]\nmodel = "kinematic"\n'
PUSH = 0.04
REST_S, PUSH_S = 1.2, 0.15
# Of a setpoint, m/s: what the widest jerk limit lets through in half a millisecond.
NOTICEABLE = 1e-4


def run(steps: int) -> dict[str, float]:
    """Measure and return p50, p99 and largest, ms, with the count."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "settings.toml").write_text(SETTINGS)
        (folder / "calm.toml").write_text(CALM)
        socket_path = str(folder / "hand.sock")
        tap = Tap()
        hand = Hand(socket_path)
        with vehicle(tap.vehicle_port, "--mission", str(folder / "calm.toml")):
            program = Program(
                "--connect", f"udpout://127.0.0.1:{tap.program_port}", "--device", f"virtual:{socket_path}",
                "--mission", str(folder / "calm.toml"), "--config", str(folder / "settings.toml"), "--logs", name,
            )  # fmt: skip
            try:
                program.engage()
                late = [_one(tap, hand, number) for number in range(steps)]
            finally:
                program.close()
                hand.close()
                tap.close()
    found = [value * 1e3 for value in late if value is not None]
    return {
        "steps": steps,
        "seen": len(found),
        "p50_ms": percentile(found, 0.5),
        "p99_ms": percentile(found, 0.99),
        "max_ms": max(found),
    }


def _one(tap: Tap, hand: Hand, number: int) -> float | None:
    """Push the handle once and return how long the wire took to carry it, s."""
    hand.put((0.0, 0.0, 0.0))
    # A random phase against the 50 Hz of the setpoints.
    time.sleep(REST_S + random.uniform(0.0, 0.04))
    tap.setpoints.clear()
    time.sleep(0.1)
    resting = [_velocity(payload) for _, payload in tap.setpoints]
    pushed = hand.put((PUSH if number % 2 else -PUSH, 0.0, 0.0))
    time.sleep(PUSH_S)
    for t, payload in list(tap.setpoints):
        if t > pushed and _leaves(resting, _velocity(payload)):
            return t - pushed
    return None


def _leaves(resting: list[tuple[float, float]], velocity: tuple[float, float]) -> bool:
    """Say whether a velocity differs from those at rest by more than they drift from one to the next."""
    drift = max((math.dist(a, b) for a, b in pairwise(resting)), default=0.0)
    return math.dist(velocity, resting[-1]) > 2.0 * drift + NOTICEABLE


def _velocity(payload: bytes) -> tuple[float, float]:
    """Return vx, vy of a SET_POSITION_TARGET_LOCAL_NED payload that starts after time_boot_ms."""
    vx, vy = struct.unpack_from("<2f", payload, 12)
    return vx, vy


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    found = run(40 if short else 300)
    return [
        f"{found['seen']} of {found['steps']} steps seen on the wire",
        f"p50 {found['p50_ms']:5.1f} ms   (bar {BAR_P50_MS:.0f} ms)",
        f"p99 {found['p99_ms']:5.1f} ms   (bar {BAR_P99_MS:.0f} ms)",
        f"max {found['max_ms']:5.1f} ms",
    ]
