"""A person's arm on a handle: mass, spring and damper between where the hand wants to be and where it is.

    m ẍ + b ẋ + k (x − x_i) = f,   b = 2 √(k m)

x is the handle, x_i the intention, f the device's force on the hand. A second-order model of arm and hand is
the field's usual one (Hogan 1989, Controlling impedance at the man/machine interface; Hasser and Cutkosky
2002, System identification of the human hand grasping a haptic knob). Mass and stiffness are those of an arm
that holds a handle in van Beek, Bergmann Tiest, Mugge and Kappers 2015 (Scientific Reports 5:18004, figure
3): 0.554 kg and 135 N/m. Their 6.45 N·s/m is of an arm that is shaken; one that reaches does so without
overshoot, so the damping here is critical. The hand covers 63 % of a step in 0.14 s and 80 % in 0.19 s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from drivers.device import ZERO3, Vector3
from drivers.vectors import within

MASS, STIFFNESS = 0.554, 135.0


class ArmState(NamedTuple):
    """Where the handle is and how it moves, m, m/s, rad, rad/s, handle frame."""

    position: Vector3 = ZERO3
    velocity: Vector3 = ZERO3
    yaw: float = 0.0
    yaw_rate: float = 0.0


@dataclass(frozen=True, slots=True)
class Arm:
    """A critically damped arm.

    Attributes:
        mass: Of hand and handle, kg.
        stiffness: Of the arm, N/m.
    """

    mass: float = MASS
    stiffness: float = STIFFNESS

    def step(
        self, state: ArmState, dt: float, intention: Vector3, intended_yaw: float, force: Vector3
    ) -> ArmState:
        """Move the handle on by `dt`, s, with intention (m, rad) and force (N) held through it.

        This is the equation's exact solution, so it is stable and passive for every dt: with
        e = x − x_i − f/k and ω = √(k/m), e(t) = (e₀ + (v₀ + ω e₀) t) e^(−ωt). Yaw follows alike, unloaded.
        """
        omega = math.sqrt(self.stiffness / self.mass)
        grown, decay = omega * dt, math.exp(-omega * dt)
        law = ((1.0 + grown) * decay, dt * decay, -omega * grown * decay, (1.0 - grown) * decay)
        (x, y, z), (u, v, w) = state.position, state.velocity
        give = 1.0 / self.stiffness
        x, u = _settle(x, u, intention[0] + force[0] * give, law)
        y, v = _settle(y, v, intention[1] + force[1] * give, law)
        z, w = _settle(z, w, intention[2] + force[2] * give, law)
        yaw, yaw_rate = _settle(state.yaw, state.yaw_rate, intended_yaw, law)
        return ArmState((x, y, z), (u, v, w), yaw, yaw_rate)

    def energy(self, state: ArmState, intention: Vector3) -> float:
        """Return ½ m |v|² + ½ k |x − x_i|², J."""
        speed = math.hypot(*state.velocity)
        stretch = math.dist(state.position, intention)
        return 0.5 * (self.mass * speed * speed + self.stiffness * stretch * stretch)


def stop(state: ArmState, workspace: float) -> ArmState:
    """Hold the handle in its workspace, a sphere of that radius, m, by a wall that does not spring back."""
    x, y, z = state.position
    if x * x + y * y + z * z <= workspace * workspace:
        return state
    position = within(state.position, workspace)
    nx, ny, nz = position[0] / workspace, position[1] / workspace, position[2] / workspace
    u, v, w = state.velocity
    outward = max(0.0, u * nx + v * ny + w * nz)
    return ArmState(
        position, (u - outward * nx, v - outward * ny, w - outward * nz), state.yaw, state.yaw_rate
    )


def _settle(
    place: float, rate: float, rest: float, law: tuple[float, float, float, float]
) -> tuple[float, float]:
    """Return place and rate after a step: `law` is the matrix that takes e and v through it, row by row."""
    error = place - rest
    return rest + law[0] * error + law[1] * rate, law[2] * error + law[3] * rate
