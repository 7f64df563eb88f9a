"""Cost and memory of `Pilot.step` with everything on and twenty obstacles around."""

from __future__ import annotations

import gc
import random
import resource
import time
from collections.abc import Iterator
from math import cos, sin, tau

from bench.rig import percentile
from drivers.device import DeviceInfo, HandleState
from groundstation.config import Settings
from groundstation.messages import Phase, Preset
from groundstation.pilot.choices import Choices
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.pilot import Memory, Pilot
from groundstation.pilot.sight import VehicleSample
from groundstation.pilot.surroundings import Surroundings
from sim.airframe import MODELS, load_airframe
from sim.scenario import Box, Cylinder, Obstacle, Sphere

BAR_US = 80.0
DT, _CUT = 0.001, False
DEVICE = DeviceInfo("bench", "", 4, 0.1, 10.0, 1000.0, 1000.0, "force")


def field(count: int = 20) -> tuple[Obstacle, ...]:
    """Return obstacles in a ring of a few metres: some are always in reach of the guard, some are not."""
    dice = random.Random(1)
    found: list[Obstacle] = []
    for number in range(count):
        angle, away = tau * number / count, dice.uniform(2.0, 9.0)
        center = (away * cos(angle), away * sin(angle), 2.0)
        found.append(
            (
                Box(f"box {number}", center, (0.6, 0.8, 3.0), 30.0 * number),
                Cylinder(f"mast {number}", center, 0.3, 4.0),
                Sphere(f"ball {number}", center, 0.5),
            )[number % 3]
        )
    return tuple(found)


class Turn:
    """A pilot with a hand that wanders and a vehicle that circles among the obstacles, telling of itself at 50 Hz."""

    def __init__(self, preset: Preset) -> None:
        chi = load_airframe("matrice_100").chi
        self._pilot = Pilot(Settings(), DEVICE, Surroundings(field(), 0.5, chi))
        self._choices = Choices(preset=preset)
        self._memory = Memory()
        self._sample = VehicleSample()
        self._tick = 0

    def run(self, ticks: int, durations: list[float] | None = None) -> None:
        """Run some ticks, and keep how long each took, s."""
        for _ in range(ticks):
            t = self._tick * DT
            if self._tick % 20 == 0:
                a = 0.5 * t
                self._sample = VehicleSample(
                    (1.5 * cos(a), 1.5 * sin(a), 2.0, 0.2 * t % 3.0),
                    (-0.75 * sin(a), 0.75 * cos(a), 0.0, 0.2),
                )
            place = (0.07 * cos(0.7 * t), 0.06 * sin(0.9 * t), 0.03 * sin(0.4 * t))
            motion = (-0.049 * sin(0.7 * t), 0.054 * cos(0.9 * t), 0.012 * cos(0.4 * t))
            hand = HandleState(place, motion, 0.3 * sin(0.3 * t), 0, homed=True, device_time=t)
            inputs = Inputs(
                DT, Phase.ENGAGED, _CUT, hand, self._sample, self._tick % 20 * DT, 0.1, 0.0, self._choices,
                ((3.0, 0.0, 2.0), (0.0, -3.0, 2.0)),
            )  # fmt: skip
            begin = time.perf_counter()
            self._memory, _ = self._pilot.step(self._memory, inputs)
            if durations is not None:
                durations.append(time.perf_counter() - begin)
            self._tick += 1


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    yield f"20 obstacles, 2 sensed points, χ compensated, 0.1 s round trip; bar: {BAR_US:.0f} µs p50"
    yield f"yardstick: a step of the rigid body in plain Python takes {1e6 * yardstick():.1f} µs p50 at this moment"
    for preset in Preset:
        turn, durations = Turn(preset), list[float]()
        turn.run(2_000)
        turn.run(5_000 if short else 50_000, durations)
        p50, p90, p99 = (1e6 * percentile(durations, share) for share in (0.5, 0.9, 0.99))
        yield f"{preset.name.lower():<12} {p50:6.1f} µs p50 {p90:7.1f} p90 {p99:7.1f} p99"
    yield from _growth(100_000 if short else 10_000_000)


def yardstick(steps: int = 5_000) -> float:
    """Return what a step of the simulator's rigid body takes now, s: what this machine is worth at the moment."""
    motion = MODELS["rigid_body"](load_airframe("x500"))
    p, v = (0.0, 0.0, 20.0, 0.0), (0.0, 0.0, 0.0, 0.0)
    durations: list[float] = []
    for _ in range(steps):
        begin = time.perf_counter()
        p, v = motion.step(p, v, (1.0, 0.5, 0.0, 0.3), (0.0, 0.0, 0.0), 4.0 * DT)
        durations.append(time.perf_counter() - begin)
    return percentile(durations, 0.5)


def _growth(ticks: int) -> Iterator[str]:
    """Yield how the process grows over many ticks, after as many as settle it."""
    turn = Turn(Preset.ASSISTED)
    turn.run(20_000)
    gc.collect()
    objects, before = len(gc.get_objects()), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    turn.run(ticks)
    gc.collect()
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    yield f"after {ticks:,} ticks: {grown:+d} kB resident, {len(gc.get_objects()) - objects:+d} objects"
