"""The face that every model of motion has. It is chosen once, with the airframe; a step does not ask which it is.

Vectors of four are `p = [x, y, z, yaw]` in the world (ENU) and `v = [forward, left, up, yaw_rate]` on the vehicle
(FLU, yaw only); SI units.
"""

from __future__ import annotations

from typing import Protocol

from sim.kinematics import Vector3, Vector4

GRAVITY = 9.80665


class Attitude(Protocol):
    """How a vehicle leans: what the vectors of four leave out."""

    @property
    def roll(self) -> float:
        """About forward, rad."""
        ...

    @property
    def pitch(self) -> float:
        """About left, rad; positive is nose down (FLU)."""
        ...

    @property
    def roll_rate(self) -> float:
        """Body rate about forward, rad/s."""
        ...

    @property
    def pitch_rate(self) -> float:
        """Body rate about left, rad/s."""
        ...

    def specific_force(self) -> Vector3:
        """Return what an ideal accelerometer measures: a + g ẑ on the leaning vehicle's axes (FLU), m/s²."""
        ...

    def onto_axes(self, vector: Vector3, /) -> Vector3:
        """Turn a vector on the heading's level axes onto the leaning vehicle's."""
        ...


class Motion(Protocol):
    """A model of flight, with the vehicle's inner state where it has one."""

    @property
    def attitude(self) -> Attitude:
        """How the vehicle leans after the last step."""
        ...

    def rest(self) -> None:
        """Stand level on something, motors idle."""
        ...

    def step(
        self, p: Vector4, v: Vector4, v_ref: Vector4 | None, wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p and v after `dt` seconds. Yaw is not wrapped.

        Args:
            p: Where the vehicle is; obstacles may have moved it since the last step.
            v: Its velocities; likewise.
            v_ref: What is asked for, or None while the motors are stopped: it falls.
            wind: The air's velocity, world, m/s.
            dt: The step, s.
        """
        ...

    def reference(self, v: Vector4, wanted: Vector4, acceleration: Vector4, /) -> Vector4:
        """Return the reference that gives `v` the rate `acceleration`, on the way to the velocities `wanted`.

        This is what the vehicle's own autopilot knows of its vehicle; an offboard reference does not pass here.
        """
        ...
