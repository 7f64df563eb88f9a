"""Flights with a known response, for identification to find."""

from __future__ import annotations

import numpy as np

from groundstation.identification.samples import Raw
from sim.airframe import load_airframe
from sim.models.dynamic import astuple, respond

RATES = np.array([0.05, 0.12, 0.23, 0.41, 0.67, 0.97])
AMPLITUDES = (0.35, 0.35, 0.25, 0.25)


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
    airframe="matrice_100", *, seconds=120.0, delay=0.0, noise=(0.02, 0.02, 0.02, 0.005), seed=0, dt=0.02
):
    """Return a flight of the simulator's dynamic model with sensors' noise on its velocities, and its χ."""
    chi = astuple(load_airframe(airframe).chi)
    t = np.arange(0.0, seconds, dt)
    ref = references(t, seed)
    late = references(t - delay, seed)
    p, v = (0.0,) * 4, (0.0,) * 4
    told = np.empty((len(t), 4))
    fine = 4
    for k in range(len(t)):
        told[k] = v
        for _ in range(fine):
            p, v = respond(p, v, tuple(late[k]), (0.0, 0.0, 0.0), (chi, 0.0, dt / fine))
    told += np.random.default_rng(seed + 1).normal(0.0, noise, told.shape)
    return Raw(t, told, ref), np.array(chi)
