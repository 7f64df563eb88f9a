"""What the hand feels: equation (5), f = −K p̃, and the other cues, each by itself and together.

p̃ = p_h − p points from the drone to where the hand wants it. A drone that is blocked while the hand goes
forward leaves p̃ pointing forward, so the force pushes the hand back. A drone that is blown along +x while the
hand rests at the centre has p̃ₓ < 0 and fₓ > 0: the hand is drawn along with the drone, as the wind blows. In
both cases giving way to the force moves p_h towards the drone.

| cue | force | says |
|---|---|---|
| position | −K p̃ | how far the drone is from where the hand wants it |
| environment | k (reach − h) n | something is near, and where away from it is |
| mismatch | k (v − v_c) | the drone does not have the velocity it is meant to have |
| guard | k (u_safe − u_cmd) | what the shield changes of what the hand asks for |
| damping | −b ẋ | the handle's own velocity |
| guidance | see `groundstation.pilot.guidance` | where the mission's way is |
"""

from __future__ import annotations

from typing import NamedTuple

from drivers.device import ZERO3, Vector3
from drivers.vectors import within
from groundstation import config
from groundstation.frames import body_from_world
from groundstation.messages import Cue
from groundstation.pilot.presets import Weights
from groundstation.pilot.shield.nearby import Near

# Plain numbers: flags of an enumeration are slow to combine.
_POSITION, _ENVIRONMENT, _MISMATCH, _GUARD, _DAMPING, _ = (int(cue) for cue in Cue)


class CueForces(NamedTuple):
    """The cues as they go into the force, N, world; damping in the handle frame."""

    position: Vector3 = ZERO3
    environment: Vector3 = ZERO3
    mismatch: Vector3 = ZERO3
    guard: Vector3 = ZERO3
    damping: Vector3 = ZERO3
    guidance: Vector3 = ZERO3


class Felt(NamedTuple):
    """What the cues are made from.

    Attributes:
        force: Equation (5), or what another controller has in its place, world, N.
        nearest: What is nearest, if anything is.
        mismatch: v − v_c, world, m/s.
        guarded: u_safe − u_cmd, world, m/s.
        velocity: Of the handle, handle frame, m/s.
    """

    force: Vector3
    nearest: Near | None
    mismatch: Vector3
    guarded: Vector3
    velocity: Vector3


class Feedback:
    """Weighs the cues.

    Args:
        settings: Their gains.
        damping: b, N·s/m, as the device renders it passively.
    """

    def __init__(self, settings: config.Cues, damping: float) -> None:
        self._settings = settings
        self._damping = damping

    def cues(self, felt: Felt, weights: Weights, on: int, share: float) -> CueForces:
        """Return each cue as it goes into the force.

        Args:
            felt: What they are made from.
            weights: The preset's.
            on: Those of `Cue` that are on.
            share: Of the gains that link and device leave, 0 to 1; in equation (5) and in damping it is already.
        """
        settings, most = self._settings, self._settings.part_limit
        force, thing, mismatched, guarded, velocity = felt
        position = environment = mismatch = guard = damping = ZERO3
        if on & _POSITION:
            position = force if weights.position == 1.0 else scaled(force, weights.position)
        if on & _ENVIRONMENT and thing is not None and thing.gap < settings.reach:
            push = settings.environment * (settings.reach - thing.gap) * weights.environment * share
            environment = scaled(thing.normal, min(push, most))
        if on & _MISMATCH and weights.mismatch:
            mismatch = within(scaled(mismatched, settings.mismatch * weights.mismatch * share), most)
        if on & _GUARD and weights.guard and guarded is not ZERO3:
            guard = within(scaled(guarded, settings.guard * weights.guard * share), most)
        if on & _DAMPING and weights.damping:
            damping = scaled(velocity, -weights.damping * self._damping)
        return CueForces(position, environment, mismatch, guard, damping)


def hand_force(cues: CueForces, turn: float, limit: float) -> Vector3:
    """Return the force to render, handle frame, N, no stronger than the device can.

    Args:
        cues: The parts.
        turn: Angle from the world's axes to the handle's, as in the mapping, rad.
        limit: Largest norm, N; a stronger force is shortened and keeps its direction.
    """
    a, b, c, d, (u, v, w), e = cues
    total = (a[0] + b[0] + c[0] + d[0], a[1] + b[1] + c[1] + d[1], a[2] + b[2] + c[2] + d[2])
    if e is not ZERO3:
        total = (total[0] + e[0], total[1] + e[1], total[2] + e[2])
    x, y, z = body_from_world(total, turn)
    return within((x + u, y + v, z + w), limit)


def scaled(vector: Vector3, factor: float) -> Vector3:
    """Return a vector made longer or shorter."""
    return vector[0] * factor, vector[1] * factor, vector[2] * factor
