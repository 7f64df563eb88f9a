"""The kinematic model: equations (1) to (3) of the paper as a vehicle."""

from __future__ import annotations

from sim.kinematics import Vector3, Vector4, advance
from sim.models.falling import Falling
from sim.models.lean import Lean


class Kinematic:
    """The ideal vehicle of equations (1) to (3): it has the velocities it is asked for, at once, in any wind.

    Args:
        air_drag: Of a fall with the motors stopped, 1/s.
        lean: Roll and pitch, which the model leaves out.
    """

    def __init__(self, air_drag: float, lean: Lean) -> None:
        self.attitude = lean
        self._falling = Falling(air_drag)

    def rest(self) -> None:
        """Stand level."""
        self.attitude.level()

    def step(
        self, p: Vector4, v: Vector4, v_ref: Vector4 | None, wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p + J(θ) v_ref dt, and v_ref; a fall with the motors stopped."""
        p, after = self._falling.step(p, v, wind, dt) if v_ref is None else (advance(p, v_ref, dt), v_ref)
        self.attitude.follow(p, v, after, wind, dt)
        return p, after

    def reference(self, _v: Vector4, wanted: Vector4, _acceleration: Vector4, /) -> Vector4:
        """Return the velocities wanted: nothing else can be asked of this model."""
        return wanted
