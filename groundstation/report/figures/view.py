"""What the views of one flight share: the mission, the way flown, and how much of the world is shown."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from groundstation.review.series import FlightSeries, Numbers
from groundstation.training.mission import Mission
from sim.environment.shapes import extent

_MARGIN_M = 0.8


class View(NamedTuple):
    """A flight to be looked at.

    Attributes:
        mission: Its obstacles, route and target.
        t: (n,), s.
        p: (n, 4), the way flown, world, m and rad.
        p_h: (n, 4), the way of the hand.
        wind: (n, 3), m/s; NaN is not known.
        radius: Of the vehicle, m.
        low, high: (3,), corners of what is shown, m.
    """

    mission: Mission
    t: Numbers
    p: Numbers
    p_h: Numbers
    wind: Numbers
    radius: float
    low: Numbers
    high: Numbers


def view_of(series: FlightSeries, mission: Mission, radius: float) -> View:
    """Return the view that holds the whole flight with all obstacles, the ground included."""
    points = [series.p[:, :3].min(axis=0), series.p[:, :3].max(axis=0)]
    points += [np.array(corner) for obstacle in mission.obstacle for corner in extent(obstacle)]
    points += [np.array(point) for point in mission.way]
    low, high = np.min(points, axis=0) - _MARGIN_M, np.max(points, axis=0) + _MARGIN_M
    low[2] = 0.0
    return View(mission, series.t, series.p, series.p_h, series.wind, radius, low, high)


def moments(t: Numbers, every: float) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return the samples at the full multiples of `every`, s."""
    wanted = np.arange(np.ceil(t[0] / every), t[-1] / every + 1e-9) * every
    return np.minimum(np.searchsorted(t, wanted), len(t) - 1)
