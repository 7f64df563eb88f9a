"""What raw sensors add to the truth: white noise, and slow wander of GPS and barometer. Seeded.

What the vehicle makes of them is `sim.estimator`'s business.
"""

from __future__ import annotations

from math import exp, sqrt
from random import Random

from sim.kinematics import Vector3

# About what an ICM-20602's noise densities (100 µg/√Hz, 4 mdps/√Hz: its datasheet) are in 100 Hz of bandwidth.
ACCELEROMETER_NOISE = 0.01
GYRO_NOISE = 0.0007
# An LIS3MDL's, ultra-high performance (its datasheet: 3.2 mgauss), gauss.
MAGNETOMETER_NOISE = 0.0032
# An MS5611's resolution at an oversampling of 4096 (its datasheet: 0.012 mbar), as height, m. The drift with weather
# and temperature is an estimate: standard deviation, m, and correlation time, s.
BAROMETER_NOISE = 0.1
BAROMETER_DRIFT, BAROMETER_TIME = 0.3, 300.0
# A single-frequency receiver's wander: standard deviation, m (horizontal, vertical), and correlation time, s.
GPS_HORIZONTAL, GPS_VERTICAL, GPS_TIME = 0.4, 0.8, 60.0


class Sensors:
    """Noise sources of one vehicle.

    Args:
        seed: Same seed, same noise.
    """

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._gps = (_Drift(self._random), _Drift(self._random), _Drift(self._random))
        self._barometer = _Drift(self._random)

    def accelerometer(self, force: Vector3) -> Vector3:
        """Return a measured specific force, m/s²."""
        return self._noisy(force, ACCELEROMETER_NOISE)

    def gyro(self, rates: Vector3) -> Vector3:
        """Return measured rates, rad/s."""
        return self._noisy(rates, GYRO_NOISE)

    def magnetometer(self, field: Vector3) -> Vector3:
        """Return a measured magnetic field, gauss."""
        return self._noisy(field, MAGNETOMETER_NOISE)

    def barometer(self, height: float, t: float) -> float:
        """Return a measured height, m, at `t` seconds since start."""
        drift = BAROMETER_DRIFT * self._barometer.at(t, BAROMETER_TIME)
        return height + drift + self._random.gauss(0.0, BAROMETER_NOISE)

    def gps(self, position: Vector3, t: float) -> Vector3:
        """Return a measured position, m, at `t` seconds since start."""
        east, north, up = (drift.at(t, GPS_TIME) for drift in self._gps)
        return (
            position[0] + GPS_HORIZONTAL * east,
            position[1] + GPS_HORIZONTAL * north,
            position[2] + GPS_VERTICAL * up,
        )

    def _noisy(self, truth: Vector3, deviation: float) -> Vector3:
        gauss = self._random.gauss
        return (
            truth[0] + gauss(0.0, deviation),
            truth[1] + gauss(0.0, deviation),
            truth[2] + gauss(0.0, deviation),
        )


class _Drift:
    """An Ornstein-Uhlenbeck process of unit spread, advanced exactly: it may be asked as often as one likes."""

    def __init__(self, random: Random) -> None:
        self._random = random
        self._t = 0.0
        self._now = random.gauss(0.0, 1.0)

    def at(self, t: float, time: float) -> float:
        """Return its value at `t`, no earlier than the last; `time` is the correlation time, s."""
        keep = exp(-(t - self._t) / time)
        self._t = t
        self._now = keep * self._now + sqrt(1.0 - keep * keep) * self._random.gauss(0.0, 1.0)
        return self._now
