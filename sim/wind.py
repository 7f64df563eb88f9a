"""Wind as the mission writes it: a constant part and discrete gusts of 1-cosine shape; a pure function of time."""

from __future__ import annotations

from math import cos, tau

from sim.kinematics import Vector3
from sim.scenario import Wind


def wind_at(wind: Wind, t: float) -> Vector3:
    """Return the air's velocity, ENU, m/s.

    A gust of duration T and peak u adds ½ u (1 − cos 2π(t − t₀)/T) while t₀ < t < t₀ + T: the discrete gust of
    CS-25.341, for which calm at both ends and the peak in the middle are given.

    Args:
        wind: The mission's wind.
        t: Seconds since take-off; before it, only the constant part blows.
    """
    east, north, up = wind.mean
    for gust in wind.gust:
        into = t - gust.start_s
        if 0.0 < into < gust.duration_s:
            share = 0.5 * (1.0 - cos(tau * into / gust.duration_s))
            east += share * gust.velocity[0]
            north += share * gust.velocity[1]
            up += share * gust.velocity[2]
    return east, north, up
