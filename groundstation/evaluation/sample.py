"""What an observer of a virtual flight is shown, 50 times a second."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from drivers.device import HandleState
from groundstation.frames import Vector3, Vector4
from groundstation.messages import Phase
from groundstation.pilot.pilot import Outputs


class Sample(NamedTuple):
    """Both sites at one moment.

    Attributes:
        t: Since take-off, s.
        phase: How far the hand is coupled.
        handle: Its state.
        outputs: Of `Pilot.step`: p_h, error, v_ref, setpoint, forces.
        p: Where the vehicle is in truth, world, m and rad.
        v: Its velocity in truth, vehicle's axes, m/s and rad/s.
        wind: At the vehicle, world, m/s.
        clearance: From its hull to the nearest obstacle, m; infinite where there is none.
        state_age: Age of the vehicle's state on the ground, s.
        round_trip: As measured, s; NaN before.
    """

    t: float
    phase: Phase
    handle: HandleState
    outputs: Outputs
    p: Vector4
    v: Vector4
    wind: Vector3
    clearance: float
    state_age: float
    round_trip: float


Observer = Callable[[Sample], None]
