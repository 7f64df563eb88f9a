"""Where the vehicle is at this tick, from where it last said it was: a thousand times a second out of fifty.

The hand must not feel the telemetry's steps. A sample is carried on with its own velocity, and where the next
one disagrees, the difference is not jumped but faded out. At a steady velocity this lags by nothing.
"""

from __future__ import annotations

from math import exp, inf
from typing import NamedTuple

from groundstation.frames import Vector4
from groundstation.pilot.controller import position_error

ZERO4: Vector4 = (0.0, 0.0, 0.0, 0.0)
# A sample is carried on for no longer than this.
FORESIGHT_S = 0.1
# In this time a disagreement between two samples falls to a third.
FADE_S = 0.05


class VehicleSample(NamedTuple):
    """Where the vehicle said it was: world position, m and rad; world velocity, m/s, and yaw rate, rad/s."""

    position: Vector4 = ZERO4
    velocity: Vector4 = ZERO4


class Sight(NamedTuple):
    """What is known between ticks: the sample, its age in s, and what is left of the last disagreement."""

    sample: VehicleSample | None = None
    age: float = 0.0
    offset: Vector4 = ZERO4


def look(sight: Sight, sample: VehicleSample, age: float, dt: float) -> tuple[Sight, Vector4]:
    """Look at the newest sample.

    Args:
        sight: Of the tick before; `Sight()` at the start.
        sample: The newest; another object than the last one only if it is another sample.
        age: Of it, s; infinite while none has come.
        dt: Since the tick before, s.

    Returns:
        The sight for the next tick, and the position now, world, m and rad.
    """
    here = carried_on(sample, age)
    x, y, z, yaw = sight.offset
    # Until the first sample comes there is one without age, of nothing: with that nothing can disagree.
    if sample is not sight.sample and sight.sample is not None and sight.age < inf:
        ex, ey, ez, e_yaw = carried_on(sight.sample, sight.age + dt)
        x, y, z, yaw = position_error((ex + x, ey + y, ez + z, e_yaw + yaw), here)
    left = exp(-dt / FADE_S)
    x, y, z, yaw = x * left, y * left, z * left, yaw * left
    position = (here[0] + x, here[1] + y, here[2] + z, here[3] + yaw)
    return Sight(sample, age, (x, y, z, yaw)), position


def carried_on(sample: VehicleSample, age: float) -> Vector4:
    """Return where a vehicle is that goes on as it was, for `FORESIGHT_S` at most; world, m and rad."""
    ahead = min(max(age, 0.0), FORESIGHT_S)
    (x, y, z, yaw), (vx, vy, vz, yaw_rate) = sample
    return x + vx * ahead, y + vy * ahead, z + vz * ahead, yaw + yaw_rate * ahead
