"""The rigid body as a model of motion, with its hidden state."""

from __future__ import annotations

from math import cos, sin

from sim.kinematics import ZERO3, ZERO4, Vector3, Vector4, wrap
from sim.models.rigid.constants import Limits, Physique, gains, hover, inertias, rotors
from sim.models.rigid.control import control
from sim.models.rigid.dynamics import State, advance
from sim.models.rigid.posture import Posture, shadow, taken

_USUAL_STEP = 0.004


class RigidBody:
    """Six degrees of freedom on four rotors, flown by its own velocity, attitude and rate control.

    The vectors of four are its shadow: p's yaw is the heading of the body's forward axis, and v lies on that
    heading's level axes.

    Args:
        physique: What it is.
        limits: Of its controllers.
    """

    def __init__(self, physique: Physique, limits: Limits) -> None:
        self._physique, self._limits = physique, limits
        self._body = inertias(physique)
        self._prepare(_USUAL_STEP)
        self.attitude = Posture(self._body)
        self._p = self._v = ZERO4
        self._stand()

    @property
    def state(self) -> State:
        """See `sim.models.rigid.dynamics`."""
        return self._state

    def place(self, state: State, integral: Vector3 = ZERO3) -> tuple[Vector4, Vector4]:
        """Take a whole state, as in mid-flight; return the p and v that belong to it."""
        self._integral = integral
        return self._follow(state, ZERO3)

    def hover(self, p: Vector4) -> tuple[Vector4, Vector4]:
        """Hover at p in still air; return p and v."""
        return self.place(*hover(p, self._rotors, self._body))

    def rest(self) -> None:
        """Stand level, rotors still."""
        if not self.attitude.resting:
            self._stand()

    def step(
        self, p: Vector4, v: Vector4, v_ref: Vector4 | None, wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p and v after `dt` seconds; yaw within [−π, π]."""
        if dt != self._dt:
            self._prepare(dt)
        if p != self._p or v != self._v:
            self._take(p, v)
        state = self._state
        if v_ref is None:
            command, self._integral = ZERO4, ZERO3
        else:
            command, self._integral = control(state, self._integral, v_ref, self._gains)
        return self._follow(advance(state, command, wind, self._rotors, self._body), wind)

    def reference(self, _v: Vector4, wanted: Vector4, _acceleration: Vector4, /) -> Vector4:
        """Return the velocities wanted: its own loops find the accelerations."""
        return wanted

    def _follow(self, state: State, wind: Vector3) -> tuple[Vector4, Vector4]:
        self._state = state
        self._p, self._v = shadow(state)
        self.attitude.follow(state, wind, self._rotors)
        return self._p, self._v

    def _stand(self) -> None:
        x, y, z, yaw = self._p
        self._state: State = (x, y, z, *ZERO3, cos(0.5 * yaw), 0.0, 0.0, sin(0.5 * yaw), *ZERO3, *ZERO4)
        self._integral, self._v = ZERO3, ZERO4
        self.attitude.rest()

    def _prepare(self, dt: float) -> None:
        self._dt = dt
        self._rotors = rotors(self._physique, dt)
        self._gains = gains(self._physique, self._limits, dt)

    def _take(self, p: Vector4, v: Vector4) -> None:
        """Be where something else has put the vehicle, and as fast; its tilt and the rest are its own."""
        if v == self._v and p[3] == self._p[3]:
            self._state = (*p[:3], *self._state[3:])
        else:
            self._state = taken(self._state, p, v, wrap(p[3] - self._p[3]), v[3] - self._v[3])
        self._p, self._v = p, v
