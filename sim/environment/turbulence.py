"""Continuous turbulence near the ground: the Dryden and the von Kármán model of MIL-F-8785C.

MIL-HDBK-1797 writes the same filters with scale lengths of half the size. Along the mean wind (u), across it (v) and
upward (w), with T = L/V the time in which a scale length passes:

    H_u(s) = σ √(2T/π) / (1 + T s),    H_v,w(s) = σ √(T/π) (1 + √3 T s) / (1 + T s)²

Below 1000 ft, h in feet: L_u = L_v = h / (0.177 + 0.000823 h)^1.2, L_w = h, σ_w a tenth of the wind at 20 ft,
σ_u = σ_v = σ_w / (0.177 + 0.000823 h)^0.4; from 10 ft to 1000 ft, beyond which their values there are kept.

The filters are advanced by their exact discrete equivalents, so what they give does not depend on the step.
"""

from __future__ import annotations

from math import exp, expm1, hypot, sqrt
from random import Random
from typing import Literal

from sim.kinematics import Vector3

_FEET = 1.0 / 0.3048
_LOWEST_FT, _HIGHEST_FT = 10.0, 1000.0
_SQRT3 = sqrt(3.0)
# Turbulence is isotropic here: the spectrum along the wind decides the one across it (Batchelor 1953, The theory of
# homogeneous turbulence). So a sum of Dryden fields whose longitudinal spectra add up to von Kármán's,
# (1 + (1.339 L Ω)²)^(−5/6), has his transverse ones too. Fitted: within 2.5 % along and 4 % across for L Ω from 0.02
# to 75. Scale lengths as multiples of L, and shares of the variance.
_MIX: dict[str, tuple[tuple[float, float], ...]] = {
    "dryden": ((1.0, 1.0),),
    "von_karman": ((1.1868, 0.8122), (0.2320, 0.1457), (0.0281, 0.0421)),
}


class Turbulence:
    """Turbulent wind at a vehicle.

    Args:
        model: Shape of the spectrum.
        random: Where chance comes from.
    """

    def __init__(self, model: Literal["dryden", "von_karman"], random: Random) -> None:
        self._fields = [(scale, sqrt(share), Dryden(random)) for scale, share in _MIX[model]]

    def step(self, height: float, airspeed: float, intensity: float, dt: float) -> Vector3:
        """Advance by `dt` seconds and return the turbulent velocity along the wind, to its left, and up, m/s.

        A field of eddies is carried past at the airspeed (Taylor's hypothesis). To one that drifts with the air it
        would stand still; but eddies turn over, in about L/σ (Tennekes and Lumley 1972, A first course in
        turbulence), so the speed V counted is √(airspeed² + σ²).

        Args:
            height: Above the ground, m.
            airspeed: Of the vehicle in the mean wind, m/s.
            intensity: σ_w, m/s, above 0.
            dt: The step, s.
        """
        way = hypot(airspeed, intensity) * dt
        level, upward, level_ratio = low_altitude(height)
        along = aside = up = 0.0
        for scale, weight, field in self._fields:
            u, v, w = field.step(way / (scale * level), way / (scale * upward))
            along, aside, up = along + weight * u, aside + weight * v, up + weight * w
        return intensity * level_ratio * along, intensity * level_ratio * aside, intensity * up


def low_altitude(height: float) -> tuple[float, float, float]:
    """Return L_u = L_v and L_w, m, and σ_u/σ_w at a height, m."""
    feet = max(_LOWEST_FT, min(_HIGHEST_FT, height * _FEET))
    shape = 0.177 + 0.000823 * feet
    return feet / shape**1.2 / _FEET, feet / _FEET, shape**-0.4


class Dryden:
    """A Dryden field of unit spread in each component, advanced by how much of it has passed.

    The transverse filter is √3/(1 + Ts) + (1 − √3)/(1 + Ts)²: a first-order process a, and b that follows a.

    Args:
        random: Where chance comes from.
    """

    def __init__(self, random: Random) -> None:
        self._gauss = gauss = random.gauss
        self._u = gauss(0.0, 1.0)
        self._across = _begun(random)
        self._up = _begun(random)

    def step(self, level: float, upward: float) -> Vector3:
        """Return u, v, w after so many level and upward scale lengths have passed."""
        keep = exp(-level)
        self._u = keep * self._u + sqrt(-expm1(-2.0 * level)) * self._gauss(0.0, 1.0)
        self._across = self._advanced(self._across, level)
        self._up = self._advanced(self._up, upward)
        return self._u, _output(self._across), _output(self._up)

    def _advanced(self, state: tuple[float, float], r: float) -> tuple[float, float]:
        """Return a and b after r = t/T: ȧ = (noise − a)/T, ḃ = (a − b)/T, with the spread of a being 1."""
        a, b = state
        keep = exp(-r)
        variance_a = -expm1(-2.0 * r)
        if r > 1e-3:
            covariance = 0.5 * (1.0 - (1.0 + 2.0 * r) * keep * keep)
            variance_b = 0.5 * (1.0 - (1.0 + 2.0 * r * (1.0 + r)) * keep * keep)
        else:
            # The differences above cancel; these are their series.
            covariance = r * r * (1.0 - 4.0 / 3.0 * r)
            variance_b = r * r * r * (2.0 / 3.0 - r)
        first = sqrt(variance_a)
        both = covariance / first
        noise = self._gauss(0.0, 1.0)
        rest = sqrt(max(0.0, variance_b - both * both))
        return keep * a + first * noise, keep * (b + r * a) + both * noise + rest * self._gauss(0.0, 1.0)


def _begun(random: Random) -> tuple[float, float]:
    """Draw a and b from what they are in the long run: variances 1 and ½, covariance ½."""
    a = random.gauss(0.0, 1.0)
    return a, 0.5 * (a + random.gauss(0.0, 1.0))


def _output(state: tuple[float, float]) -> float:
    """Return √3 a + (1 − √3) b, whose variance is 2, at unit spread."""
    return sqrt(0.5) * (_SQRT3 * state[0] + (1.0 - _SQRT3) * state[1])
