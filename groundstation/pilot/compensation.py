"""Dynamic compensation: the reference that makes a vehicle of known response χ have the velocity it is meant to have.

    v_ref = M (v̇_c + K₄ tanh(K₄⁻¹ K₃ (v_c − v))) + C(ω) v_c

The model v_ref = M v̇ + C(ω) v solved for its reference, with the wanted acceleration and a bounded pull on the
velocity error. With a delay, v is the forecast: what the vehicle will fly as the reference reaches it.
"""

from __future__ import annotations

from math import exp, tanh

from groundstation.frames import Vector4
from sim.models.dynamic import Chi


class Compensation:
    """The inverse of a response.

    Args:
        chi: Of the airframe.
        k4: Diagonal of K₄, the most that a velocity error pulls, m/s² and rad/s².
    """

    def __init__(self, chi: Chi, k4: Vector4) -> None:
        self._m = (chi.chi_1, chi.chi_3, chi.chi_5, chi.chi_9)
        self._c = (chi.chi_10, chi.chi_11, chi.chi_13, chi.chi_14, chi.chi_16, chi.chi_19)
        self._k4 = k4

    def reference(
        self, meant: Vector4, acceleration: Vector4, error: Vector4, yaw_rate: float, k3: Vector4
    ) -> Vector4:
        """Return v_ref, vehicle's axes, m/s and rad/s.

        Args:
            meant: v_c, m/s and rad/s.
            acceleration: v̇_c, m/s² and rad/s².
            error: v_c − v, m/s and rad/s.
            yaw_rate: ω, rad/s.
            k3: Diagonal of K₃ as the delay leaves it, 1/s.
        """
        m1, m3, m5, m9 = self._m
        c10, c11, c13, c14, c16, c19 = self._c
        k4 = self._k4
        forward, left, up, turn = meant
        a, b, c, d = (
            acceleration[0] + k4[0] * tanh(k3[0] * error[0] / k4[0]),
            acceleration[1] + k4[1] * tanh(k3[1] * error[1] / k4[1]),
            acceleration[2] + k4[2] * tanh(k3[2] * error[2] / k4[2]),
            acceleration[3] + k4[3] * tanh(k3[3] * error[3] / k4[3]),
        )
        return (
            m1 * a + c10 * forward + yaw_rate * c11 * left,
            m3 * b + yaw_rate * c13 * forward + c14 * left,
            m5 * c + c16 * up,
            m9 * d + c19 * turn,
        )


def lagged(before: Vector4, meant: Vector4, delay: float, dt: float) -> Vector4:
    """Return v_c as it was about a delay ago: a first-order lag of the same mean delay, s; none without a delay."""
    if delay <= dt:
        return meant
    share = 1.0 - exp(-dt / delay)
    a, b, c, d = before
    return (
        a + share * (meant[0] - a),
        b + share * (meant[1] - b),
        c + share * (meant[2] - c),
        d + share * (meant[3] - d),
    )
