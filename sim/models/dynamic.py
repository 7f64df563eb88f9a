"""The identified dynamic model: a velocity response, linear in its parameters χ.

`respond` and what it calls are one source for floats, rows and numba, see `sim.models.one_source`.
"""

from __future__ import annotations

from math import cos, sin

from msgspec import Struct
from msgspec.structs import astuple

from sim.kinematics import Vector3, Vector4
from sim.models.falling import Falling
from sim.models.lean import Lean

# χ in the order of `Chi`.
ChiTuple = tuple[float, float, float, float, float, float, float, float, float, float]
Response = tuple[ChiTuple, float, float]


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

    Args:
        chi: The airframe's parameters.
        air_drag: D, 1/s; see `respond`.
        lean: Roll and pitch, which the model leaves out.
    """

    def __init__(self, chi: Chi, air_drag: float, lean: Lean) -> None:
        self.attitude = lean
        self._chi: ChiTuple = astuple(chi)
        self._drag = air_drag
        self._falling = Falling(air_drag)

    def rest(self) -> None:
        """Stand level."""
        self.attitude.level()

    def step(
        self, p: Vector4, v: Vector4, v_ref: Vector4 | None, wind: Vector3, dt: float, /
    ) -> tuple[Vector4, Vector4]:
        """Return p and v after `dt` seconds, and lean accordingly."""
        if v_ref is None:
            p, after = self._falling.step(p, v, wind, dt)
        else:
            p, after = respond(p, v, v_ref, wind, (self._chi, self._drag, dt))
        self.attitude.follow(p, v, after, wind, dt)
        return p, after

    def reference(self, v: Vector4, _wanted: Vector4, acceleration: Vector4, /) -> Vector4:
        """Return M a + C(ω) v: the model solved for its reference."""
        v_l, v_m, v_n, omega = v
        m_1, m_3, m_5, m_9, c_10, c_11, c_13, c_14, c_16, c_19 = self._chi
        return (
            m_1 * acceleration[0] + c_10 * v_l + omega * c_11 * v_m,
            m_3 * acceleration[1] + omega * c_13 * v_l + c_14 * v_m,
            m_5 * acceleration[2] + c_16 * v_n,
            m_9 * acceleration[3] + c_19 * omega,
        )


def rate(v: Vector4, v_ref: Vector4, push: Vector3, chi: ChiTuple) -> Vector4:
    """Return v̇ = M⁻¹ (v_ref − C(ω) v) + push.

    Args:
        v: Velocities, m/s and rad/s.
        v_ref: References, m/s and rad/s.
        push: Disturbing acceleration on the vehicle's axes, m/s².
        chi: χ.
    """
    v_l, v_m, v_n, omega = v
    m_1, m_3, m_5, m_9, c_10, c_11, c_13, c_14, c_16, c_19 = chi
    return (
        (v_ref[0] - c_10 * v_l - omega * c_11 * v_m) / m_1 + push[0],
        (v_ref[1] - omega * c_13 * v_l - c_14 * v_m) / m_3 + push[1],
        (v_ref[2] - c_16 * v_n) / m_5 + push[2],
        (v_ref[3] - c_19 * omega) / m_9,
    )


def along(v: Vector4, rate: Vector4, dt: float) -> Vector4:
    """Return v after `dt` seconds at a rate."""
    return v[0] + rate[0] * dt, v[1] + rate[1] * dt, v[2] + rate[2] * dt, v[3] + rate[3] * dt


def carried(p: Vector4, before: Vector4, after: Vector4, dt: float) -> Vector4:
    """Integrate equation (2) by the mean velocity at the mean yaw: second order in dt."""
    omega = 0.5 * (before[3] + after[3])
    forward, left, up = (
        0.5 * (before[0] + after[0]),
        0.5 * (before[1] + after[1]),
        0.5 * (before[2] + after[2]),
    )
    middle = p[3] + 0.5 * omega * dt
    c, s = cos(middle), sin(middle)
    return (
        p[0] + (c * forward - s * left) * dt,
        p[1] + (s * forward + c * left) * dt,
        p[2] + up * dt,
        p[3] + omega * dt,
    )


def respond(
    p: Vector4, v: Vector4, v_ref: Vector4, wind: Vector3, constants: Response
) -> tuple[Vector4, Vector4]:
    """Return p and v one step later, v by a fourth-order Runge-Kutta step.

    Wind is not in the identified model. Seen as linear drag, air pulls with −D (v − w): the part −D v is in the
    identified C already, so what wind adds is the acceleration D·w on the vehicle's axes.

    Args:
        p: `[x, y, z, yaw]`, world.
        v: `[forward, left, up, yaw_rate]`.
        v_ref: What is asked for.
        wind: The air's velocity, world, m/s.
        constants: χ; D, 1/s; the step, s.
    """
    chi, drag, dt = constants
    c, s = cos(p[3]), sin(p[3])
    push = (drag * (c * wind[0] + s * wind[1]), drag * (c * wind[1] - s * wind[0]), drag * wind[2])
    half, sixth = 0.5 * dt, dt / 6.0
    k1 = rate(v, v_ref, push, chi)
    k2 = rate(along(v, k1, half), v_ref, push, chi)
    k3 = rate(along(v, k2, half), v_ref, push, chi)
    k4 = rate(along(v, k3, dt), v_ref, push, chi)
    after = (
        v[0] + sixth * (k1[0] + 2.0 * (k2[0] + k3[0]) + k4[0]),
        v[1] + sixth * (k1[1] + 2.0 * (k2[1] + k3[1]) + k4[1]),
        v[2] + sixth * (k1[2] + 2.0 * (k2[2] + k3[2]) + k4[2]),
        v[3] + sixth * (k1[3] + 2.0 * (k2[3] + k3[3]) + k4[3]),
    )
    return carried(p, v, after, dt), after
