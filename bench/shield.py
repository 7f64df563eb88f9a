"""Full-stick adversaries through obstacle fields, the same seeds with the barrier, without it, and with a risk field.

Each run has a field, an adversary, a round trip from 0 to 0.3 s and a wind of its own. The vehicle is the
identified Matrice 100, whose response the pilot knows; then a rigid body with PX4's cascade, whose it does not. Who
loses sight of the vehicle is uncoupled as in flight. A run counts as one with collisions when the vehicle touched
anything, the ground included; it ends early when its motors stop.
"""

from __future__ import annotations

import os
import statistics
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from random import Random
from typing import NamedTuple

import msgspec

from drivers.device import DeviceInfo
from groundstation.config import Settings
from groundstation.evaluation.fields import middles, obstacle_field
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import Adversary
from groundstation.evaluation.sample import Sample
from groundstation.pilot.mapping import RateMapping
from sim.channel import Conditions
from sim.environment.world import FLOOR_NAME
from sim.scenario import EstimateChoice, Scenario, VehicleChoice, Wind

GUARDS = ("barrier", "off", "risk_field")
RUNS, RUNS_UNKNOWN, SECONDS = 1000, 200, 20.0
KNOWN = VehicleChoice(airframe="matrice_100", model="dynamic")
UNKNOWN = VehicleChoice(airframe="x500", model="rigid_body")
LONGEST_ROUND_TRIP_S, STRONGEST_WIND = 0.3, 1.0
RATE = 250.0


class Told(NamedTuple):
    """How a run went: contacts with what, least clearance, m, way flown, m, and how often it was uncoupled."""

    collisions: tuple[str, ...]
    clearance: float
    way: float
    uncoupled: int


class Eye:
    """Sees how near the vehicle came to anything, and how far it flew."""

    def __init__(self) -> None:
        self.clearance = float("inf")
        self.way = 0.0
        self.grounded = False
        self._last = None

    def __call__(self, sample: Sample) -> None:
        self.clearance = min(self.clearance, sample.clearance)
        here = sample.p[:3]
        if self._last is not None:
            self.way += sum((a - b) ** 2 for a, b in zip(here, self._last, strict=True)) ** 0.5
        self._last = here
        self.grounded = self.grounded or here[2] <= 0.0


def fly(
    seed: int, guard: str, vehicle: VehicleChoice = KNOWN, seconds: float = SECONDS, rate: float = RATE
) -> Told:
    """Fly one adversary through one field; all but guard and vehicle follows from the seed."""
    random = Random(f"shield {seed}")
    delay = 0.5 * random.uniform(0.0, LONGEST_ROUND_TRIP_S)
    wind = (
        random.uniform(-STRONGEST_WIND, STRONGEST_WIND),
        random.uniform(-STRONGEST_WIND, STRONGEST_WIND),
        0.0,
    )
    obstacles = obstacle_field(seed)
    settings = Settings()
    settings = msgspec.structs.replace(settings, shield=msgspec.structs.replace(settings.shield, guard=guard))
    scenario = Scenario(vehicle, Wind(wind), obstacles, estimate=EstimateChoice("rtk"))
    channel = Conditions(delay=delay)
    setup = Setup(scenario, settings=settings, rate=rate, up=channel, down=channel, seed=seed)

    def hand(mapping: RateMapping, device: DeviceInfo) -> Adversary:
        return Adversary(mapping, device.workspace, settings.mapping.yaw_range, middles(obstacles), seed)

    eye = Eye()
    flight = VirtualFlight(setup, hand, (eye,))
    autopilot = flight.vehicle.autopilot
    flight.fly(seconds, lambda: not autopilot.armed)
    struck = [collision.name for collision in flight.vehicle.collisions]
    if eye.grounded and FLOOR_NAME not in struck:
        struck.append(FLOOR_NAME)
    return Told(tuple(struck), eye.clearance, eye.way, flight.local.coupling.losses)


def main(*, short: bool) -> Iterator[str]:
    """Yield the tables."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for name, vehicle, runs in (
            ("Matrice 100, χ known", KNOWN, RUNS),
            ("X500 as a rigid body, response unknown", UNKNOWN, RUNS_UNKNOWN),
        ):
            seeds = range(40 if short else runs)
            yield (
                f"{name}: {len(seeds)} seeds x {SECONDS:.0f} s, round trip 0 to {LONGEST_ROUND_TRIP_S} s, "
                f"servo {RATE:.0f} Hz; bar: 0 with the barrier"
            )
            yield "guard        runs with collisions   contacts   least clearance   way flown   uncoupled"
            for guard in GUARDS:
                told = list(pool.map(partial(fly, guard=guard, vehicle=vehicle), seeds, chunksize=4))
                yield row(guard, told)
                hit = [str(seed) for seed, run in zip(seeds, told, strict=True) if run.collisions]
                if guard == "barrier" and hit:
                    yield f"VIOLATED with seeds {', '.join(hit[:20])}"


def row(guard: str, told: list[Told]) -> str:
    """Return one guard's line."""
    return (
        f"{guard:<12} {sum(bool(run.collisions) for run in told):>20} {sum(len(run.collisions) for run in told):>10}"
        f" {min(run.clearance for run in told):>15.2f} m {statistics.mean(run.way for run in told):>9.1f} m"
        f" {sum(run.uncoupled for run in told):>11}"
    )
