"""The presets: which cues the hand feels, whether the guard and the compensation are on, how fast it goes."""

from __future__ import annotations

from typing import NamedTuple


class Weights(NamedTuple):
    """Weight of each cue in the force."""

    position: float
    environment: float
    mismatch: float
    guard: float
    damping: float
    guidance: float


class Assistance(NamedTuple):
    """What a preset is.

    Attributes:
        weights: Of the cues.
        guard: The shield is on.
        compensation: The vehicle's response is compensated where it is known.
        speed: Share of the speeds.
    """

    weights: Weights
    guard: bool
    compensation: bool
    speed: float


# In the order of `Preset`.
PRESETS: tuple[Assistance, ...] = (
    # Exactly equations (4) and (5): what the hand asks for is flown, also into an obstacle.
    Assistance(Weights(1.0, 0.0, 0.0, 0.0, 0.0, 0.0), guard=False, compensation=False, speed=1.0),
    Assistance(Weights(1.0, 1.0, 0.0, 1.0, 1.0, 1.0), guard=True, compensation=True, speed=1.0),
    # The drone itself, and as little else as possible; the guard stays, silently.
    Assistance(Weights(1.0, 0.0, 1.0, 0.0, 0.0, 0.0), guard=True, compensation=True, speed=1.0),
    Assistance(Weights(1.0, 1.5, 0.0, 1.5, 1.0, 1.0), guard=True, compensation=True, speed=0.6),
)
