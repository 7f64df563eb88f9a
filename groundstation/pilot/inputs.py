"""What one tick of the pilot is made from."""

from __future__ import annotations

from math import nan
from typing import NamedTuple

from drivers.device import HandleState, Vector3
from groundstation.messages import Phase
from groundstation.pilot.choices import Choices
from groundstation.pilot.sight import VehicleSample


class Inputs(NamedTuple):
    """What one tick is made from.

    Attributes:
        dt: Since the last tick, s.
        phase: How far the hand is coupled.
        cut: No force from this very tick on, not even a fading one.
        hand: The handle.
        vehicle: The newest sample of the vehicle.
        state_age: Its age, s.
        delay: Measured round trip, s; NaN while it is not known.
        loss: Share of the vehicle's frames lost lately, 0 to 1.
        choices: The operator's.
        seen: Points of obstacles that the vehicle's own sensors see, world, m.
    """

    dt: float
    phase: Phase
    cut: bool
    hand: HandleState
    vehicle: VehicleSample
    state_age: float
    delay: float = nan
    loss: float = 0.0
    choices: Choices = Choices()
    seen: tuple[Vector3, ...] = ()
