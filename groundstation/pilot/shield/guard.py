"""What a guard looks at and answers; and the one that changes nothing."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from drivers.device import Vector3
from groundstation.frames import Vector4
from groundstation.pilot.shield.nearby import Near


class Situation(NamedTuple):
    """What a guard looks at.

    Attributes:
        near: What is near where the vehicle will be.
        velocity: The vehicle's then, world, m/s.
        yaw: Its yaw then, rad.
        push: Disturbing acceleration, world, m/s².
    """

    near: tuple[Near, ...]
    velocity: Vector3
    yaw: float
    push: Vector3


class Guarded(NamedTuple):
    """What a guard makes of a velocity.

    Attributes:
        velocity: The one that may be flown, vehicle's axes, m/s and rad/s.
        by: What it keeps away from, or "" where nothing was changed.
    """

    velocity: Vector4
    by: str = ""


class Guard(Protocol):
    """Makes a velocity safe."""

    def reach(self, speed: float) -> float:
        """Return the gap up to which things matter at a speed, m/s; m."""
        ...

    def guard(self, wanted: Vector4, situation: Situation) -> Guarded:
        """Return the velocity nearest to the wanted one that is safe; vehicle's axes, m/s and rad/s."""
        ...


class Off:
    """No guard: everything that is wanted is flown."""

    def reach(self, speed: float) -> float:  # noqa: ARG002
        """Return 0: nothing matters."""
        return 0.0

    def guard(self, wanted: Vector4, situation: Situation) -> Guarded:  # noqa: ARG002
        """Return what is wanted."""
        return Guarded(wanted)
