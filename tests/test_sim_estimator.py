"""What the vehicle believes: how far it wanders, that its parts belong together, and what losing GPS does."""

import functools
import math
import statistics
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.estimator import COASTS_S, QUALITIES, Estimator, _discrete
from sim.kinematics import ZERO4, world_rates

START = (0.0, 0.0, 0.0, 0.3)
WANDERING = [name for name in QUALITIES if name != "ideal"]


@functools.cache
def stood(quality, dt, seconds, seed=1):
    """Return the estimates of a vehicle that stands still, as rows [p, v]."""
    estimator = Estimator(quality, Random(seed), START)
    rows = []
    for _ in range(round(seconds / dt)):
        p, v, _ = estimator.step(START, ZERO4, dt)
        rows.append((*p, *v))
    return np.array(rows)


def test_ideal_is_the_truth():
    estimator = Estimator("ideal", Random(0), START)
    p, v = (1.0, -2.0, 3.0, 3.1), (0.5, 0.1, -0.2, 0.7)
    assert estimator.step(p, v, 0.004) == (p, v, True)
    assert estimator.followed(v) == v


@pytest.mark.parametrize(("rate", "leak"), [(1 / 3, 1 / 60), (1 / 2, 1 / 10), (1 / 60, 0.0)])
@pytest.mark.parametrize("dt", [0.004, 0.02, 0.5, 7.0])
def test_two_steps_are_one_of_twice_the_length(rate, leak, dt):
    """The mark of an exact discretisation."""

    def law(step):
        keep_e, keep_d, carried, first, both, rest = _discrete(0.03, rate, leak, step)
        factor = np.array([[first, 0.0], [both, rest]])
        return np.array([[keep_e, 0.0], [carried, keep_d]]), factor @ factor.T

    once, added = law(dt)
    twice, added_twice = law(2.0 * dt)
    assert once @ once == pytest.approx(twice, rel=1e-9)
    assert once @ added @ once.T + added == pytest.approx(added_twice, rel=1e-5)


@pytest.mark.parametrize("quality", WANDERING)
@pytest.mark.parametrize("dt", [0.02, 0.5])
def test_the_wander_is_as_wide_as_the_quality_says_at_any_step(quality, dt):
    """Over hundreds of correlation times; exact for the long run, whatever the step."""
    level, height = QUALITIES[quality].level, QUALITIES[quality].height
    rows = stood(quality, dt, 30_000.0 if dt > 0.1 else 8_000.0)
    loose = 0.15 if dt > 0.1 else 0.3
    assert np.std(rows[:, :2]) == pytest.approx(level.spread, rel=loose)
    assert np.std(rows[:, 2]) == pytest.approx(height.spread, rel=2 * loose)
    assert np.std(rows[:, 4:6]) == pytest.approx(level.velocity_spread, rel=0.1)
    assert np.std(rows[:, 3]) == pytest.approx(QUALITIES[quality].yaw, rel=loose)


@pytest.mark.parametrize("quality", WANDERING)
def test_position_and_velocity_belong_together(quality):
    """The height's error is the sum of its velocity's, less what leaks away."""
    rows = stood(quality, 0.02, 2_000.0)
    height, climb = rows[:, 2], rows[:, 6]
    moved = height[50::50] - height[:-50:50]
    sums = np.stack(
        [np.add.reduceat(row, np.arange(0, len(rows), 50))[: len(moved)] * 0.02 for row in (height, climb)]
    )
    expected = sums[1] - sums[0] / QUALITIES[quality].height.time
    assert np.std(moved - expected) < 0.05 * np.std(moved)


def test_it_begins_where_the_filter_was_set_and_the_same_seed_wanders_the_same():
    rows = stood("gps", 0.02, 100.0)
    assert np.abs(rows[0] - (*START, *ZERO4)).max() < 0.01
    assert np.array_equal(rows, stood.__wrapped__("gps", 0.02, 100.0))
    assert not np.array_equal(rows, stood("gps", 0.02, 100.0, seed=2))


def test_it_lags_a_steady_flight_by_the_lag_and_velocity_not_at_all():
    estimator = Estimator("gps", Random(0), (0.0, 0.0, 0.0, 0.0))
    for number in range(1, 251):
        p, v, _ = estimator.step((5.0 * 0.004 * number, 0.0, 0.0, 0.0), (5.0, 0.0, 0.0, 0.0), 0.004)
    assert 5.0 - p[0] == pytest.approx(5.0 * QUALITIES["gps"].lag, abs=0.1)
    assert v[0] == pytest.approx(5.0, abs=0.15)


angles = st.floats(-math.pi, math.pi)


@given(angles, st.tuples(*[st.floats(-5, 5)] * 4), st.integers(0, 99))
def test_a_vehicle_that_follows_is_seen_to_do_what_it_was_asked(yaw, v_ref, seed):
    """Without its lag, the estimated velocity of one that has the true velocities is the reference."""
    estimator = Estimator("gps", Random(seed), (0.0, 0.0, 0.0, yaw))
    estimator._quality = estimator._quality._replace(lag=0.0)
    p = (0.0, 0.0, 0.0, yaw)
    for _ in range(5):
        estimator.step(p, ZERO4, 10.0)
    truth = estimator.followed(v_ref)
    assert math.dist(truth, v_ref) > 1e-4
    assert estimator.step(p, truth, 0.004).v == pytest.approx(v_ref, abs=1e-9)


def drifts(quality, seconds, seeds=60):
    """Return how far the estimates are off some time after the loss of GPS, and whether they are trusted."""
    off, trusted = [], set()
    for seed in range(seeds):
        estimator = Estimator(quality, Random(seed), START)
        estimator.lose_gps(lost=True)
        for _ in range(round(seconds / 0.02)):
            p, _, valid = estimator.step(START, ZERO4, 0.02)
        off.append(math.hypot(p[0], p[1]))
        trusted.add(valid)
    return statistics.fmean(off), trusted


@pytest.mark.parametrize("quality", QUALITIES)
def test_without_gps_it_drifts_away_and_is_trusted_for_five_seconds(quality):
    early, trusted = drifts(quality, COASTS_S - 0.1)
    assert trusted == {True}
    late, trusted = drifts(quality, 10.0)
    assert trusted == {False}
    assert late > 1.0
    assert late > 2.0 * early


def test_height_and_heading_do_not_need_gps():
    estimator = Estimator("ideal", Random(0), START)
    estimator.lose_gps(lost=True)
    for _ in range(1000):
        p, v, _ = estimator.step(START, ZERO4, 0.02)
    assert p[2:] == pytest.approx(START[2:])
    assert v[2:] == (0.0, 0.0)


@pytest.mark.parametrize("quality", QUALITIES)
def test_gps_that_comes_back_sets_it_right(quality):
    estimator = Estimator(quality, Random(5), START)
    estimator.lose_gps(lost=True)
    for _ in range(1500):
        estimator.step(START, ZERO4, 0.02)
    assert math.hypot(*estimator.estimate.p[:2]) > 1.0
    estimator.lose_gps(lost=True)
    assert not estimator.estimate.valid_position
    estimator.lose_gps(lost=False)
    p, _, valid = estimator.step(START, ZERO4, 0.02)
    assert valid
    assert math.hypot(*p[:2]) < 0.05


@pytest.mark.parametrize("quality", QUALITIES)
def test_what_is_believed_does_not_change_the_truth_told_to_it(quality):
    estimator = Estimator(quality, Random(0), START)
    p, v = (1.0, 2.0, 3.0, -3.14), (1.0, 0.0, 0.0, 0.0)
    for _ in range(500):
        believed = estimator.step(p, v, 0.02)
    assert -math.pi < believed.p[3] <= math.pi
    assert math.dist(believed.p[:3], p[:3]) < 1.0
    assert world_rates(believed.p[3], believed.v)[0] == pytest.approx(-1.0, abs=0.2)
