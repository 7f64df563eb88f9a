"""A flight as arrays: how near obstacles were, and when."""

import numpy as np
import numpy.testing as npt
from series_support import STEP_S, a_series

from groundstation.review.series import approaches, clearances, lengths
from sim.scenario import Box, Sphere

BALL = Sphere("ball", (0.0, 0.0, 1.0), 0.5)


def near(clearance, names):
    """Return a series in which obstacles are so near, a sample a second."""
    count = len(clearance)
    series = a_series(count * STEP_S, lag=0.0)
    return series._replace(t=np.arange(float(count)), clearance=np.array(clearance), nearest=np.array(names))


def test_clearance_is_counted_from_the_hull_to_the_nearest_obstacle():
    points = np.array([(2.0, 0.0, 1.0, 0.0), (0.0, 4.0, 1.0, 0.0)])
    wall = Box("wall", (0.0, 5.0, 1.0), (4.0, 1.0, 2.0))
    distance, names = clearances(points, (BALL, wall), 0.3)
    npt.assert_allclose(distance, (1.2, 0.2))
    assert list(names) == ["ball", "wall"]


def test_without_obstacles_the_clearance_is_infinite():
    distance, names = clearances(np.zeros((2, 4)), (), 0.3)
    assert np.isinf(distance).all()
    assert list(names) == ["", ""]


def test_each_time_near_an_obstacle_is_one_approach_with_its_name_and_least_clearance():
    series = near([2.0, 0.8, 0.5, 0.9, 1.5, 0.7, 0.6], ["a", "a", "a", "b", "b", "b", "b"])
    assert list(approaches(series, 1.0)) == [
        (1.0, 3.0, "a", 0.5),
        (3.0, 4.0, "b", 0.9),
        (5.0, 6.0, "b", 0.6),
    ]


def test_where_nothing_is_near_there_is_no_approach():
    assert list(approaches(near([2.0, 2.0], ["a", "a"]), 1.0)) == []


def test_one_that_is_near_all_the_time_is_one_approach_from_start_to_end():
    assert list(approaches(near([0.4, 0.3, 0.4], ["a", "a", "a"]), 1.0)) == [(0.0, 2.0, "a", 0.3)]


def test_lengths_leave_yaw_out():
    npt.assert_allclose(lengths(np.array([(3.0, 4.0, 0.0, 100.0), (0.0, 0.0, 2.0, 0.0)])), (5.0, 2.0))
