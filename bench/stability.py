"""How well the drone follows the hand, and whether anything swings, with the delays that links have.

A hand sweeps for a while and lets go. Tracking is |p_h − p| as it truly is while the hand sweeps, with the identified
Matrice 100, without wind. Stability is told by what is left at the end, well after the hand has let go: the drone's
speed, and p̃.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from math import dist, hypot, sin, sqrt
from typing import NamedTuple

from drivers.device import DeviceInfo
from groundstation.config import Control, Mapping, Settings
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.sample import Sample
from groundstation.messages import Phase
from groundstation.pilot.mapping import Displacement, RateMapping
from groundstation.pilot.sight import VehicleSample
from sim.channel import Conditions
from sim.scenario import Scenario

BAR_TRACKING_M = 0.10
STILL_SPEED, STILL_ERROR_M = 0.05, 0.05
SWEEP_S, REST_S = 20.0, 40.0
PRESETS = ("paper", "assisted", "transparent", "training")
PASSIVITIES = ("observer", "wave", "tank")


class Told(NamedTuple):
    """RMS and largest |p_h − p| while sweeping, m; speed, m/s, and |p̃|, m, over the last second; uncouplings."""

    rms: float
    largest: float
    speed: float
    error: float
    uncoupled: int


class Sweeper:
    """A hand that wishes smooth velocities, about a metre a second, and then lets go."""

    def __init__(self, mapping: RateMapping, workspace: float, mode: str) -> None:
        self._mapping, self._workspace, self._by_place = mapping, workspace, mode == "position"
        self._began: float | None = None

    def decide(self, t: float, sample: VehicleSample) -> Displacement:
        """Return where the handle should be."""
        began = self._began = t if self._began is None else self._began
        since = t - began
        if since > SWEEP_S:
            return Displacement((0.0, 0.0, 0.0), 0.0)
        fade = min(1.0, since / 2.0, (SWEEP_S - since) / 2.0)
        waves = (
            1.2 * sin(0.6 * since),
            sin(0.9 * since + 0.5),
            0.4 * sin(0.5 * since),
            0.3 * sin(0.4 * since),
        )
        if self._by_place:
            reach = 0.6 * self._workspace * fade
            return Displacement((reach * waves[0], reach * waves[1], reach * waves[2]), 0.0)
        x, y, z, turn = (fade * wave for wave in waves)
        return self._mapping.displacement_for((x, y, z, turn), sample.position[3])


def fly(case: tuple[str, str, str, float], rate: float = 250.0) -> Told:
    """Fly a preset, mapping and passivity over a round trip, s."""
    preset, mode, passivity, delay = case
    settings = Settings(control=Control(preset=preset, passivity=passivity), mapping=Mapping(mode=mode))  # pyright: ignore[reportArgumentType]
    channel = Conditions(delay=0.5 * delay)
    seen: list[tuple[float, float, float, float]] = []

    def watch(sample: Sample) -> None:
        if sample.phase is Phase.ENGAGED:
            apart = dist(sample.outputs.p_h[:3], sample.p[:3])
            seen.append((sample.t, apart, hypot(*sample.v[:3]), hypot(*sample.outputs.error[:3])))

    def hand(mapping: RateMapping, device: DeviceInfo) -> Sweeper:
        return Sweeper(mapping, device.workspace, mode)

    setup = Setup(Scenario(), altitude=5.0, settings=settings, rate=rate, up=channel, down=channel)
    flight = VirtualFlight(setup, hand, (watch,))
    flight.fly(SWEEP_S + REST_S)
    begin = seen[0][0]
    sweep = [apart for t, apart, _, _ in seen if 3.0 < t - begin < SWEEP_S]
    last = [(speed, error) for t, _, speed, error in seen if t > seen[-1][0] - 1.0]
    return Told(
        sqrt(sum(a * a for a in sweep) / len(sweep)),
        max(sweep),
        max(speed for speed, _ in last),
        max(error for _, error in last),
        flight.local.coupling.losses,
    )


def main(*, short: bool) -> Iterator[str]:
    """Yield the tables."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        yield f"tracking without delay, servo 1000 Hz; bar: {BAR_TRACKING_M:.2f} m RMS with compensation"
        for preset in ("assisted", "paper"):
            told = fly((preset, "rate", "observer", 0.0), rate=1000.0)
            yield (
                f"{preset:<12} {'compensated' if preset != 'paper' else 'as it is':<12} {told.rms:6.3f} m RMS "
                f"{told.largest:6.3f} m at most"
            )
        yield f"round trip 0.7 s: RMS while sweeping; what is left {REST_S:.0f} s after the hand let go"
        passivities = PASSIVITIES[:1] if short else PASSIVITIES
        cases = [(*each, 0.7) for each in itertools.product(PRESETS, ("rate", "position"), passivities)]
        for case, told in zip(cases, pool.map(fly, cases), strict=True):
            settled = told.speed < STILL_SPEED and told.error < STILL_ERROR_M and not told.uncoupled
            yield (
                f"{case[0]:<12} {case[1]:<9} {case[2]:<9} {told.rms:6.3f} m RMS  {told.speed:7.4f} m/s "
                f"{told.error:7.4f} m  {'settles' if settled else 'DOES NOT SETTLE'}"
            )
