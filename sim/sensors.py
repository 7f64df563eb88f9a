"""What raw sensors add to the truth: white noise on the inertial unit, a slow wander on GPS. Seeded.

The vehicle's estimates (position, velocity, attitude) are taken as ideal; only raw measurements are noisy.
"""

from __future__ import annotations

from math import exp, sqrt
from random import Random

from sim.kinematics import Vector3

# About what an ICM-20602's noise densities (100 µg/√Hz, 4 mdps/√Hz: its datasheet) are in 100 Hz of bandwidth.
ACCELEROMETER_NOISE = 0.01
GYRO_NOISE = 0.0007
# A single-frequency receiver's wander: standard deviation, m (horizontal, vertical), and correlation time, s.
GPS_HORIZONTAL, GPS_VERTICAL, GPS_TIME = 0.4, 0.8, 60.0


class Sensors:
    """Noise sources of one vehicle.

    Args:
        seed: Same seed, same noise.
    """

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._gps_t: float | None = None
        self._gps = (0.0, 0.0, 0.0)

    def accelerometer(self, force: Vector3) -> Vector3:
        """Return a measured specific force, m/s²."""
        return self._noisy(force, ACCELEROMETER_NOISE)

    def gyro(self, rates: Vector3) -> Vector3:
        """Return measured rates, rad/s."""
        return self._noisy(rates, GYRO_NOISE)

    def gps(self, position: Vector3, t: float) -> Vector3:
        """Return a measured position, m.

        The error is an Ornstein-Uhlenbeck process, advanced exactly: its spread does not depend on how often it is
        asked for.
        """
        keep = 0.0 if self._gps_t is None else exp(-(t - self._gps_t) / GPS_TIME)
        fresh = sqrt(1.0 - keep * keep)
        self._gps_t = t
        gauss = self._random.gauss
        x, y, z = self._gps
        self._gps = (
            keep * x + fresh * gauss(0.0, GPS_HORIZONTAL),
            keep * y + fresh * gauss(0.0, GPS_HORIZONTAL),
            keep * z + fresh * gauss(0.0, GPS_VERTICAL),
        )
        return position[0] + self._gps[0], position[1] + self._gps[1], position[2] + self._gps[2]

    def _noisy(self, truth: Vector3, deviation: float) -> Vector3:
        gauss = self._random.gauss
        return (
            truth[0] + gauss(0.0, deviation),
            truth[1] + gauss(0.0, deviation),
            truth[2] + gauss(0.0, deviation),
        )
