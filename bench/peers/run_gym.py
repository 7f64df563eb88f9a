"""gym-pybullet-drones: VelocityAviary, its velocity PID on PyBullet's physics, without pictures or effects."""

from __future__ import annotations

import contextlib
import io
import warnings

import numpy as np
from meter import Contest, serve

warnings.filterwarnings("ignore")
from gym_pybullet_drones.envs.VelocityAviary import VelocityAviary  # noqa: E402
from gym_pybullet_drones.utils.enums import DroneModel, Physics  # noqa: E402


def aviary(control_hz: int, physics_hz: int):
    """Return a step of control, physics_hz / control_hz steps of physics, of a vehicle at half its speed."""
    with contextlib.redirect_stdout(io.StringIO()):
        env = VelocityAviary(
            drone_model=DroneModel.CF2X, num_drones=1, initial_xyzs=np.array([[0.0, 0.0, 1.0]]),
            physics=Physics.PYB, pyb_freq=physics_hz, ctrl_freq=control_hz,
            gui=False, record=False, obstacles=False,
        )  # fmt: skip
        env.reset()
    action = np.array([[1.0, 0.0, 0.0, 0.5]])
    return lambda: env.step(action)


serve(
    [
        Contest("gym-pybullet-drones", 1, aviary(250, 250)),
        Contest("gym-pybullet-drones, control every 4th step", 4, aviary(250, 1000)),
    ]
)
