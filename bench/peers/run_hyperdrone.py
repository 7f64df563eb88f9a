"""HyperDrone's dynamics: an X500 with motor lag, RK4 in float32, no controller, one core."""

from __future__ import annotations

import numpy as np
from hyperdrone import dynamics
from meter import Contest, serve


def fleet(n: int):
    """Return a step of n vehicles."""
    sim = dynamics.Sim(n, parameters={"dynamics": {"dynamics": {"model": "x500_sim"}}}, seed=0, device="cpu")
    sim.reset()
    motors = np.zeros((n, 4), np.float32)
    return lambda: sim.step(motors)


serve([Contest("HyperDrone", 1, fleet(1)), Contest("HyperDrone × 1000", 1000, fleet(1000))])
