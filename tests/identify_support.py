"""Flights with a known response, for identification to find."""

from __future__ import annotations

from random import Random

import numpy as np

from groundstation.identification.samples import Raw, Samples, on_grid
from sim.airframe import load_airframe
from sim.estimator import Estimator
from sim.models.dynamic import astuple, respond

RATES = np.array([0.05, 0.12, 0.23, 0.41, 0.67, 0.97])
AMPLITUDES = (0.35, 0.35, 0.25, 0.25)
# Of telemetry, s; the vehicle is flown in finer steps.
DT, FINE = 0.02, 8
NOISE = (0.02, 0.02, 0.02, 0.005)


def references(t, seed):
    """Return a multisine an axis with frequencies of its own, (n, 4)."""
    random = np.random.default_rng(seed)
    phases = random.uniform(0.0, 2.0 * np.pi, (4, len(RATES)))
    return np.column_stack(
        [
            AMPLITUDES[axis]
            * np.sin(2.0 * np.pi * (RATES + 0.013 * axis) * t[:, None] + phases[axis]).sum(axis=1)
            for axis in range(4)
        ]
    )


def a_flight(
    airframe="matrice_100",
    *,
    seconds=120.0,
    delay=0.0,
    noise=NOISE,
    estimate="ideal",
    wind=(0.0, 0.0, 0.0),
    seed=0,
):
    """Fly the simulator's dynamic model.

    Args:
        airframe: A preset with a χ.
        seconds: How long.
        delay: From a reference's sending to its effect, s.
        noise: Standard deviation of white noise on the velocities that are told, m/s and rad/s.
        estimate: Of `sim.estimator.QUALITIES`: what the vehicle believes of its motion, and strives by.
        wind: World, m/s.
        seed: Of references and noise.

    Returns:
        The flight as telemetry tells it, and its χ.
    """
    frame = load_airframe(airframe)
    chi = astuple(frame.chi)
    t = np.arange(0.0, seconds, DT)
    ref = references(t, seed)
    p, v = (0.0,) * 4, (0.0,) * 4
    estimator = Estimator(estimate, Random(seed), p)
    told, yaw = np.empty((len(t), 4)), np.empty(len(t))
    on_the_way = [(0.0,) * 4] * round(delay * FINE / DT)
    for k, asked in enumerate(map(tuple, ref.tolist())):
        told[k], yaw[k] = estimator.estimate.v, estimator.estimate.p[3]
        for _ in range(FINE):
            on_the_way.append(asked)
            followed = estimator.followed(on_the_way.pop(0))
            p, v = respond(p, v, followed, wind, (chi, frame.air_drag, DT / FINE))
            estimator.step(p, v, DT / FINE)
    told += np.random.default_rng(seed + 1).normal(0.0, noise, told.shape)
    return Raw(t, told, yaw, t, ref), np.array(chi)


def gridded(raw: Raw, name: str = "flight") -> Samples:
    """Return a flight on the grid of its telemetry."""
    return on_grid(name, raw, DT)
