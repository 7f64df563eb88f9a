"""How exactly `groundstation identify` finds the χ that made a flight: every preset, several seeds, sensors' noise.

The flights are of the simulator's dynamic model at 50 Hz of telemetry, 120 s of multisines, the vehicle 0.06 s late.
What is told of them is white noise on the velocities, or what the simulated autopilot believes of its motion.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np

from groundstation.identification.fit import identify
from groundstation.identification.response import CHI, NAMES
from groundstation.identification.validate import validated
from sim.airframe import PRESETS_FOLDER, load_airframe

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
from identify_support import NOISE, a_flight, gridded

BAR = 0.02
DELAY_S = 0.06
# Of each kind: white noise, estimate, wind, and the bar on the largest error of a parameter; none for what lags as a
# GPS receiver's filter, 0.05 s of low-pass that is taken for a delay and a little inertia.
CALM, WINDY, SILENT = (0.0, 0.0, 0.0), (2.0, -1.0, 0.0), (0.0, 0.0, 0.0, 0.0)
KINDS = {
    "white": (NOISE, "ideal", CALM, BAR),
    "rtk": (SILENT, "rtk", CALM, BAR),
    "rtk, wind": (SILENT, "rtk", WINDY, BAR),
    "gps": (SILENT, "gps", CALM, None),
}


class Told(NamedTuple):
    """What came of a flight: relative errors of χ, (10,), and whether each is within its interval."""

    errors: np.ndarray
    inside: np.ndarray


def found(case: tuple[str, str, int]) -> Told:
    """Fly and identify: preset, kind, seed."""
    airframe, kind, seed = case
    noise, estimate, wind, _ = KINDS[kind]
    raw, chi = a_flight(airframe, delay=DELAY_S, noise=noise, estimate=estimate, wind=wind, seed=100 * seed)
    identified = identify([gridded(raw)])
    errors = identified.parameters.chi / chi - 1.0
    return Told(errors, (identified.low[:CHI] <= chi) & (chi <= identified.high[:CHI]))


def presets() -> list[str]:
    """Return the airframes with a χ."""
    names = sorted(path.stem for path in PRESETS_FOLDER.glob("*.toml"))
    return [name for name in names if load_airframe(name).chi is not None]


def long_flight(seconds: float) -> tuple[float, float]:
    """Return the seconds of processor time that a long flight's identification and its validation take."""
    flight = gridded(a_flight(seconds=seconds)[0])
    began = time.process_time()
    of = identify([flight]).parameters
    between = time.process_time()
    validated(of.chi, of.delays, flight)
    return between - began, time.process_time() - between


def main(*, short: bool) -> Iterator[str]:
    """Yield the tables."""
    seeds = range(1 if short else 5)
    names = ["matrice_100", "x500"] if short else presets()
    yield f"largest error of χ, %, over {len(seeds)} seeds; bar {100 * BAR:g} but for gps"
    yield (
        f"{'':<14}{'told by':<12}"
        + "".join(f"{name.removeprefix('chi_'):>7}" for name in NAMES)
        + f"{'all':>8}"
    )
    inside: dict[str, list[np.ndarray]] = {kind: [] for kind in KINDS}
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for name in names:
            cases = [(name, kind, seed) for kind in KINDS for seed in seeds]
            tolds = dict(zip(cases, pool.map(found, cases), strict=True))
            for kind, (*_, bar) in KINDS.items():
                mine = [tolds[name, kind, seed] for seed in seeds]
                inside[kind] += [told.inside for told in mine]
                errors = np.abs([told.errors for told in mine]).max(axis=0)
                verdict = "" if bar is None else ("  holds" if errors.max() <= bar else "  FAILS")
                cells = "".join(f"{100 * error:7.2f}" for error in errors)
                yield f"{name:<14}{kind:<12}{cells}{100 * errors.max():8.2f}{verdict}"
    for kind, each in inside.items():
        yield f"95 % intervals that hold the true value, {kind}: {100 * np.mean(each):.0f} %"
    if not short:
        identifying, validating = long_flight(600.0)
        yield f"a flight of 600 s: {identifying:.1f} s to identify, {validating:.1f} s to validate, of one core"
