"""The Falcon's driver: exactness, what it makes of spoilt bytes, and what a tick of it costs.

Bars: FK∘IK ≤ 1 µm over the workspace; Jacobian within 1e-4 of central differences; saturated force within 0.1° of
what was asked; 1 % of bytes dropped, doubled or cut off over 10⁶ replies: no false event, in step again within two.
"""

from __future__ import annotations

import math
import random
import resource
import subprocess
import sys
import time
from collections.abc import Iterator

from bench.rig import percentile
from drivers.emulators.faults import Faults
from drivers.falcon.driver import Falcon
from drivers.falcon.guard import Guard
from drivers.falcon.kinematics import CENTRE, angles, combine, locate, slopes
from drivers.falcon.packet import ALL_LEGS, LARGEST_FORCE, Reader, Reply, encode_reply
from drivers.falcon.units import ANGLE_AT_ZERO, COUNT, force_counts

RADIUS = 0.05
TICK_S = 1e-3
EMULATOR = """
import time
from drivers.emulators.hand import circle
from drivers.emulators.registry import make_emulator, serve
emulator = make_emulator("falcon", time.monotonic, motion=circle(0.02, 2.0))
print(emulator.uri, flush=True)
serve(emulator, lambda: True)
"""


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    lines = [*geometry(2_000 if short else 100_000)]
    for name, faults in {
        "dropped": Faults(drop=0.01),
        "doubled": Faults(duplicate=0.01),
        "cut off": Faults(truncate=0.01),
        "of all three": Faults(0.01 / 3, 0.01 / 3, 0.01 / 3),
    }.items():
        lines.append(f"1 % {name:<12} {line(spoilt(100_000 if short else 1_000_000, faults))}")
    return [*lines, *ticks(2.0 if short else 10.0)]


def places(count: int, chance: random.Random) -> Iterator[tuple[float, float, float]]:
    """Yield positions all over a ball around the centre, m."""
    while count:
        x, y, z = (chance.uniform(-RADIUS, RADIUS) for _ in range(3))
        if math.hypot(x, y, z) <= RADIUS:
            count -= 1
            yield CENTRE[0] + x, CENTRE[1] + y, CENTRE[2] + z


def geometry(count: int) -> list[str]:
    """Measure the kinematics over the workspace."""
    chance = random.Random(1)
    error = slope_error = turned = 0.0
    for place in places(count, chance):
        pose = locate(angles(place))
        assert pose is not None
        error = max(error, math.dist(pose.position, place))
        slope_error = max(slope_error, worst_slope(place))
        force = tuple(chance.gauss(0.0, 20.0) for _ in range(3))
        counts = force_counts(pose, force)
        if max(map(abs, counts)) >= LARGEST_FORCE:
            felt = combine(slopes(place), tuple(-count / 1e4 for count in counts))
            turned = max(turned, angle_between(force, felt))
    path = [
        (0.03 * math.sin(t / 150), 0.03 * math.cos(t / 150), CENTRE[2] + 0.01 * math.sin(t / 40))
        for t in range(20_000)
    ]
    legs = [angles(place) for place in path]
    at = path[0]
    began = time.perf_counter()
    for standing in legs:
        pose = locate(standing, at)
        assert pose is not None
        at = pose.position
    spent = (time.perf_counter() - began) / len(legs)
    return [
        f"FK(IK(p)) within {error * 1e6:.1e} µm over {count} places in a ball of {RADIUS * 1e3:.0f} mm   (bar 1 µm)",
        f"Jacobian within {slope_error:.1e} of central differences   (bar 1e-4)",
        f"saturated force turned by {turned:.4f}° at most   (bar 0.1°)",
        f"FK at 0.2 m/s, 1 kHz: {spent * 1e6:.1f} µs a sample",
    ]


def worst_slope(place: tuple[float, float, float], step: float = 1e-5) -> float:
    """Return the largest error of a leg's slopes against central differences, relative to the slopes' norm."""
    rows = slopes(place)
    numeric = [[0.0] * 3 for _ in range(3)]
    for axis in range(3):
        ahead, behind = list(place), list(place)
        ahead[axis] += step
        behind[axis] -= step
        for leg, (late, early) in enumerate(zip(angles(tuple(ahead)), angles(tuple(behind)), strict=True)):
            numeric[leg][axis] = (late - early) / (2.0 * step)
    return max(math.dist(row, other) / math.hypot(*row) for row, other in zip(rows, numeric, strict=True))


def angle_between(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    """Return the angle between two vectors, degrees; exact for small ones, unlike the arc cosine."""
    unit_a, unit_b = ([x / math.hypot(*v) for x in v] for v in (a, b))
    return math.degrees(2.0 * math.asin(min(1.0, math.dist(unit_a, unit_b) / 2.0)))


def spoilt(count: int, faults: Faults) -> dict[str, float]:
    """Send replies of a moving, homed handle with a button now and then over a bad line, and judge what comes out.

    Every reply is distinguishable from its neighbours; a button changes twice a second.
    """
    reader, guard = Reader(), Guard()
    false_events = believed = wrong = farthest = behind = longest = 0
    buttons = before = 0
    held = (0, False)
    for tick in range(count):
        t = tick * TICK_S
        if tick % 500 == 0:
            before, buttons = buttons, (buttons + 5) % 16
        true = encoders(t)
        sent = encode_reply(Reply(true, buttons, ALL_LEGS))
        come = faults.spoil(sent)
        in_step = False
        for reply in reader.replies(come):
            if guard.take(t, reply):
                in_step = True
                believed += 1
                off = max(abs(a - b) for a, b in zip(reply.encoders, true, strict=True))
                wrong += off > 0
                farthest = max(farthest, off)
        if (guard.buttons, guard.homed) != held:
            held = (guard.buttons, guard.homed)
            false_events += tick > 50 and (not guard.homed or guard.buttons not in {before, buttons})
        # An untouched reply that is not believed at once is one of those it takes to be in step again.
        behind = 0 if in_step else behind + (come == sent)
        longest = max(longest, behind)
    return {
        "replies": count, "faults": faults.events, "believed": believed, "wrong": wrong, "farthest": farthest,
        "false_events": false_events, "longest": longest,
    }  # fmt: skip


def encoders(t: float) -> tuple[int, int, int]:
    """Return the counts of a handle that goes round at up to 0.2 m/s."""
    place = (0.03 * math.sin(6.0 * t), 0.02 * math.cos(5.0 * t), CENTRE[2] + 0.02 * math.sin(7.0 * t))
    a, b, c = angles(place)
    return tuple(round((angle - ANGLE_AT_ZERO) / COUNT) for angle in (a, b, c))


def line(found: dict[str, float]) -> str:
    return (
        f"{found['replies']:.0f} replies, {found['faults']:.0f} faults: {found['believed']:.0f} believed, "
        f"{found['wrong']:.0f} of them wrong (by {found['farthest']:.0f} counts at most); "
        f"false events {found['false_events']:.0f}   (bar 0); in step after {found['longest'] + 1:.0f}   (bar 2)"
    )


def ticks(seconds: float) -> list[str]:
    """Run driver and emulator in two processes at 1 kHz and measure both."""
    emulator = subprocess.Popen(
        [sys.executable, "-c", EMULATOR], stdout=subprocess.PIPE, text=True, bufsize=1
    )
    try:
        assert emulator.stdout is not None
        address = emulator.stdout.readline().strip().partition(":")[2]
        device = Falcon(address)
        device.open()
        found = _tick(device, seconds)
        device.close()
    finally:
        emulator.terminate()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        emulator.wait()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return [*found, f"emulator: {used / (seconds + 1.0):.0%} of a core   (bar 30 %)"]


def _tick(device: Falcon, seconds: float) -> list[str]:
    reads: list[float] = []
    writes: list[float] = []
    ages: list[float] = []
    new, last = 0, -math.inf
    due = time.monotonic()
    ready = due + 1.0
    while due < ready + seconds:
        due += TICK_S
        time.sleep(max(due - time.monotonic(), 0.0))
        a = time.perf_counter()
        state = device.read()
        b = time.perf_counter()
        x, y, z = state.position
        device.write_force((-20.0 * x, -20.0 * y, -20.0 * z))
        c = time.perf_counter()
        if due < ready:
            continue
        reads.append(b - a)
        writes.append(c - b)
        ages.append(time.monotonic() - state.device_time)
        new += state.device_time > last
        last = state.device_time
    return [
        f"{name:<6} p50 {percentile(found, 0.5) * 1e6:6.1f} µs, p99 {percentile(found, 0.99) * 1e6:6.1f} µs"
        for name, found in {"read": reads, "write": writes, "age": ages}.items()
    ] + [f"ticks with a new sample: {new / len(reads):.2%} of {len(reads)}"]
