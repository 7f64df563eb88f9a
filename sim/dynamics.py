"""How a vehicle moves when it is asked for velocities: the kinematic model, or the identified dynamic one.

Both have the same face, `Motion`. It is chosen once, with the airframe; a step does not ask which it is. Vectors of
four are `p = [x, y, z, yaw]` in the world and `v = [forward, left, up, yaw_rate]` on the vehicle; SI units.
"""

from __future__ import annotations

from math import cos, sin
from typing import Protocol

from msgspec import Struct

from sim.kinematics import Vector3, Vector4, advance

GRAVITY = 9.80665


class Body(Protocol):
    """Something that moves."""

    def step(
        self, p: Vector4, v: Vector4, v_ref: Vector4, wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p and v after `dt` seconds of the reference `v_ref` in wind (world, m/s). Yaw is not wrapped."""
        ...


class Motion(Body, Protocol):
    """A model of flight."""

    def reference(self, v: Vector4, wanted: Vector4, acceleration: Vector4, /) -> Vector4:
        """Return the reference that gives `v` the rate `acceleration`, on the way to the velocities `wanted`.

        This is what the vehicle's own autopilot knows of its vehicle; an offboard reference does not pass here.
        """
        ...


class Kinematic:
    """The ideal vehicle of equations (1) to (3): it has the velocities it is asked for, at once, in any wind."""

    def step(
        self, p: Vector4, _v: Vector4, v_ref: Vector4, _wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p + J(θ) v_ref dt, and v_ref."""
        return advance(p, v_ref, dt), v_ref

    def reference(self, _v: Vector4, wanted: Vector4, _acceleration: Vector4, /) -> Vector4:
        """Return the velocities wanted: nothing else can be asked of this model."""
        return wanted


class Chi(Struct, frozen=True, forbid_unknown_fields=True):
    """The active parameters χ of `v_ref = M v̇ + C(ω) v` for a point at the centre of mass.

    M = diag(χ₁, χ₃, χ₅, χ₉) and C(ω) = [[χ₁₀, ω χ₁₁, 0, 0], [ω χ₁₃, χ₁₄, 0, 0], [0, 0, χ₁₆, 0], [0, 0, 0, χ₁₉]]
    with ω the yaw rate. Numbering, form and the Matrice 100's values: public repository
    bryansgue/Identificacion_M100.

    Attributes:
        chi_1, chi_3, chi_5, chi_9: Inertia of forward, left, up, yaw rate, s.
        chi_10, chi_14, chi_16, chi_19: Damping of the same, dimensionless; its inverse is the gain at rest.
        chi_11, chi_13: What a left velocity does forward, and a forward one left, while turning, s.
    """

    chi_1: float
    chi_3: float
    chi_5: float
    chi_9: float
    chi_10: float
    chi_11: float
    chi_13: float
    chi_14: float
    chi_16: float
    chi_19: float


class Dynamic:
    """The identified velocity response `v_ref = M v̇ + C(ω) v`, in wind.

    Wind is not in the identified model. Seen as linear drag, air pulls with −D (v − w): the part −D v is in the
    identified C already, so what wind adds is the acceleration D·w on the vehicle's axes.

    Args:
        chi: The airframe's parameters.
        air_drag: D, 1/s.
    """

    def __init__(self, chi: Chi, air_drag: float) -> None:
        self._m = (chi.chi_1, chi.chi_3, chi.chi_5, chi.chi_9)
        self._c = (chi.chi_10, chi.chi_11, chi.chi_13, chi.chi_14, chi.chi_16, chi.chi_19)
        self._drag = air_drag

    def rate(self, v: Vector4, v_ref: Vector4, push: Vector3) -> Vector4:
        """Return v̇ = M⁻¹ (v_ref − C(ω) v) + push.

        Args:
            v: Velocities, m/s and rad/s.
            v_ref: References, m/s and rad/s.
            push: Disturbing acceleration on the vehicle's axes, m/s².
        """
        v_l, v_m, v_n, omega = v
        m_1, m_3, m_5, m_9 = self._m
        c_10, c_11, c_13, c_14, c_16, c_19 = self._c
        return (
            (v_ref[0] - c_10 * v_l - omega * c_11 * v_m) / m_1 + push[0],
            (v_ref[1] - omega * c_13 * v_l - c_14 * v_m) / m_3 + push[1],
            (v_ref[2] - c_16 * v_n) / m_5 + push[2],
            (v_ref[3] - c_19 * omega) / m_9,
        )

    def step(
        self, p: Vector4, v: Vector4, v_ref: Vector4, wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p and v one fourth-order Runge-Kutta step of v later; p by the mean velocity at the mean yaw."""
        c, s, drag = cos(p[3]), sin(p[3]), self._drag
        push = (drag * (c * wind[0] + s * wind[1]), drag * (c * wind[1] - s * wind[0]), drag * wind[2])
        half = 0.5 * dt
        k1 = self.rate(v, v_ref, push)
        k2 = self.rate(_along(v, k1, half), v_ref, push)
        k3 = self.rate(_along(v, k2, half), v_ref, push)
        k4 = self.rate(_along(v, k3, dt), v_ref, push)
        sixth = dt / 6.0
        after = (
            v[0] + sixth * (k1[0] + 2.0 * (k2[0] + k3[0]) + k4[0]),
            v[1] + sixth * (k1[1] + 2.0 * (k2[1] + k3[1]) + k4[1]),
            v[2] + sixth * (k1[2] + 2.0 * (k2[2] + k3[2]) + k4[2]),
            v[3] + sixth * (k1[3] + 2.0 * (k2[3] + k3[3]) + k4[3]),
        )
        return _carried(p, v, after, dt), after

    def reference(self, v: Vector4, _wanted: Vector4, acceleration: Vector4, /) -> Vector4:
        """Return M a + C(ω) v: the model solved for its reference."""
        v_l, v_m, v_n, omega = v
        m_1, m_3, m_5, m_9 = self._m
        c_10, c_11, c_13, c_14, c_16, c_19 = self._c
        return (
            m_1 * acceleration[0] + c_10 * v_l + omega * c_11 * v_m,
            m_3 * acceleration[1] + omega * c_13 * v_l + c_14 * v_m,
            m_5 * acceleration[2] + c_16 * v_n,
            m_9 * acceleration[3] + c_19 * omega,
        )


class Falling:
    """A vehicle whose motors have stopped in the air: gravity and linear drag −D (v − w); it keeps its yaw rate.

    Args:
        air_drag: D, 1/s.
    """

    def __init__(self, air_drag: float) -> None:
        self._drag = air_drag

    def step(
        self, p: Vector4, v: Vector4, _v_ref: Vector4, wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p and v after `dt` seconds of fall; what is asked for does not matter."""
        c, s, drag = cos(p[3]), sin(p[3]), self._drag
        forward = drag * (c * wind[0] + s * wind[1] - v[0]) + v[3] * v[1]
        left = drag * (c * wind[1] - s * wind[0] - v[1]) - v[3] * v[0]
        up = drag * (wind[2] - v[2]) - GRAVITY
        after = (v[0] + forward * dt, v[1] + left * dt, v[2] + up * dt, v[3])
        return _carried(p, v, after, dt), after


def _along(v: Vector4, rate: Vector4, dt: float) -> Vector4:
    return v[0] + rate[0] * dt, v[1] + rate[1] * dt, v[2] + rate[2] * dt, v[3] + rate[3] * dt


def _carried(p: Vector4, before: Vector4, after: Vector4, dt: float) -> Vector4:
    """Integrate equation (2) by the mean velocity at the mean yaw: second order in dt."""
    forward, left, up, omega = (
        0.5 * (before[0] + after[0]),
        0.5 * (before[1] + after[1]),
        0.5 * (before[2] + after[2]),
        0.5 * (before[3] + after[3]),
    )
    middle = p[3] + 0.5 * omega * dt
    c, s = cos(middle), sin(middle)
    return (
        p[0] + (c * forward - s * left) * dt,
        p[1] + (s * forward + c * left) * dt,
        p[2] + up * dt,
        p[3] + omega * dt,
    )
