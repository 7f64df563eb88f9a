"""Wind at the vehicle: a constant part and discrete gusts as the mission writes them, and turbulence.

The constant part and the turbulence's intensity are parameters too, SIM_WIND_E, _N, _U and SIM_WIND_TURB, so that
any ground station can change them in flight.
"""

from __future__ import annotations

from math import cos, hypot, sqrt, tau
from random import Random

from sim.autopilot.parameters import Parameters
from sim.environment.turbulence import Turbulence
from sim.kinematics import ZERO3, Vector3, Vector4, world_rates
from sim.scenario import Gust, Wind

_MEAN = ("SIM_WIND_E", "SIM_WIND_N", "SIM_WIND_U")
_INTENSITY = "SIM_WIND_TURB"
# No gust that moves a multirotor is shorter than a few such times, s: in between turbulence is held.
_EVERY_S = 0.02
_NEARLY = 1e-9


class Air:
    """The moving air.

    Args:
        wind: The mission's.
        parameters: Take the mission's values, and may change them later.
        random: Where turbulence comes from.
    """

    def __init__(self, wind: Wind, parameters: Parameters, random: Random) -> None:
        self._gusts = wind.gust
        self._turbulence = Turbulence(wind.turbulence.model, random)
        self._waited = 0.0
        self._turbulent = ZERO3
        self._parameters = parameters
        for name, value in zip((*_MEAN, _INTENSITY), (*wind.mean, wind.turbulence.intensity), strict=True):
            parameters.set(name, value)
        self._read()

    def step(self, p: Vector4, v: Vector4, t: float, dt: float) -> Vector3:
        """Return the air's velocity, ENU, m/s.

        Args:
            p: Where the vehicle is.
            v: Its velocities.
            t: Seconds since take-off; before it, no gust blows.
            dt: Since the last call, s.
        """
        if self._parameters.changed != self._seen:
            self._read()
        wind = self._mean
        if self._gusts:
            wind = gusty(wind, self._gusts, t)
        if self._intensity > 0.0:
            self._waited += dt
            if self._waited >= _EVERY_S - _NEARLY:
                self._stir(p, v, self._waited)
                self._waited = 0.0
            east, north, up = self._turbulent
            wind = (wind[0] + east, wind[1] + north, wind[2] + up)
        return wind

    def add(self, gust: Gust) -> None:
        """Let another gust blow."""
        self._gusts = (*self._gusts, gust)

    def _stir(self, p: Vector4, v: Vector4, dt: float) -> None:
        """Move the turbulent part on by `dt` seconds: its first axis lies along the mean wind, or east in calm."""
        x, y, z, _ = world_rates(p[3], v)
        east, north, up = self._mean
        airspeed = sqrt((x - east) ** 2 + (y - north) ** 2 + (z - up) ** 2)
        along, left, upward = self._turbulence.step(p[2], airspeed, self._intensity, dt)
        c, s = self._along
        self._turbulent = (c * along - s * left, s * along + c * left, upward)

    def _read(self) -> None:
        parameters = self._parameters
        self._seen = parameters.changed
        east, north, up = (parameters[name] for name in _MEAN)
        self._mean: Vector3 = (east, north, up)
        self._intensity = parameters[_INTENSITY]
        level = hypot(east, north)
        self._along = (east / level, north / level) if level > 0.0 else (1.0, 0.0)


def gusty(mean: Vector3, gusts: tuple[Gust, ...], t: float) -> Vector3:
    """Return the mean wind and the gusts at `t` seconds since take-off, m/s.

    A gust of duration T and peak u adds ½ u (1 − cos 2π(t − t₀)/T) while t₀ < t < t₀ + T: the discrete gust of
    CS-25.341, for which calm at both ends and the peak in the middle are given.
    """
    east, north, up = mean
    for gust in gusts:
        into = t - gust.start_s
        if 0.0 < into < gust.duration_s:
            share = 0.5 * (1.0 - cos(tau * into / gust.duration_s))
            east += share * gust.velocity[0]
            north += share * gust.velocity[1]
            up += share * gust.velocity[2]
    return east, north, up
