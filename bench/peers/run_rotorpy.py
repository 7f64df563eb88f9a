"""RotorPy's Hummingbird under its velocity control, as its class comes: RK45, drag on; and its batch in torch."""

from __future__ import annotations

import contextlib
import math

import numpy as np
from meter import Contest, serve
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import BatchedMultirotor, BatchedMultirotorParams, Multirotor

DT = 0.004
WANTED = (1.0, 0.5, 0.2)
HOVER = math.sqrt(quad_params["mass"] * 9.81 / (4.0 * quad_params["k_eta"]))


class One:
    def __init__(self) -> None:
        self.state = {
            "x": np.zeros(3), "v": np.zeros(3), "q": np.array([0.0, 0.0, 0.0, 1.0]), "w": np.zeros(3),
            "wind": np.zeros(3), "rotor_speeds": np.full(4, HOVER),
        }  # fmt: skip
        self.vehicle = Multirotor(quad_params, self.state, control_abstraction="cmd_vel")
        self.control = {"cmd_v": np.array(WANTED)}

    def step(self) -> None:
        self.state = self.vehicle.step(self.state, self.control, DT)


class Many:
    """Its fixed-step integrator, rk4, which is its faster one; indices as a tensor, likewise."""

    def __init__(self, n: int) -> None:
        device = torch.device("cpu")
        quaternion = torch.zeros(n, 4, dtype=torch.double)
        quaternion[:, 3] = 1.0
        three = torch.zeros(n, 3, dtype=torch.double)
        self.state = {
            "x": three.clone(), "v": three.clone(), "q": quaternion, "w": three.clone(), "wind": three.clone(),
            "rotor_speeds": torch.full((n, 4), HOVER, dtype=torch.double),
        }  # fmt: skip
        parameters = BatchedMultirotorParams([quad_params] * n, n, device)
        self.vehicle = BatchedMultirotor(
            parameters, n, self.state, device, control_abstraction="cmd_vel", integrator="rk4"
        )
        self.control = {"cmd_v": torch.tensor(WANTED, dtype=torch.double).repeat(n, 1)}
        self.all = torch.arange(n)

    def step(self) -> None:
        self.state = self.vehicle.step(self.state, self.control, DT, self.all)


contests = [Contest("RotorPy", 1, One().step)]
with contextlib.suppress(ModuleNotFoundError):
    import torch

    torch.set_num_threads(1)
    torch.set_grad_enabled(False)
    contests += [Contest(f"RotorPy, torch × {n}", n, Many(n).step) for n in (100, 1000)]
serve(contests)
