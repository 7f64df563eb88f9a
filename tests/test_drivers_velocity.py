"""Adaptive windowing: exact on what is exact, quiet on what is quantised, quick on what is quick."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from drivers.velocity import Windowed


def follow(motion, ticks=400, quantum=1.0, tick=1e-3):
    axis = Windowed(quantum)
    return [axis.add(n * tick, round(motion(n * tick) / quantum) * quantum) for n in range(1, ticks)]


@given(st.floats(-5_000, 5_000))
@example(125.0)
@example(1500.0)
def test_a_steady_motion_is_known_to_a_count_a_window(speed):
    """The line through 20 intervals of 1 ms is off by at most one count in 20 ms."""
    for velocity in follow(lambda t: speed * t)[30:]:
        assert abs(velocity - speed) <= 1.0 / 0.020 + 1e-6 * abs(speed)


def test_a_count_that_flickers_is_no_motion():
    axis = Windowed(1.0)
    velocities = [axis.add(n * 1e-3, n // 3 % 2) for n in range(1, 300)]
    assert max(map(abs, velocities[30:])) <= 1.0 / 0.020 + 1e-9


def test_fast_motion_is_followed_at_once():
    """A step of speed, 0 to 3000 counts/s, is seen within three samples; the long window alone would need 20."""
    velocities = follow(lambda t: max(0.0, t - 0.2) * 3000.0)
    assert abs(velocities[195]) <= 1.0
    assert velocities[205] > 2500.0


def test_it_is_nearer_the_truth_than_differences_and_than_a_fixed_filter():
    """A hand's sine, 30 mm at 1 Hz, on an encoder of 0.05 mm."""

    def motion(t):
        return 600.0 * math.sin(math.tau * t)

    def truth(t):
        return 600.0 * math.tau * math.cos(math.tau * t)

    found = follow(motion, 1500)
    places = [round(motion(n * 1e-3)) for n in range(1500)]
    differences = [(b - a) / 1e-3 for a, b in pairwise(places)]
    smooth, value = [], 0.0
    for difference in differences:
        value += (difference - value) * 0.1
        smooth.append(value)

    def rms(values):
        errors = [value - truth((n + 1) * 1e-3) for n, value in enumerate(values)][100:]
        return math.sqrt(sum(error * error for error in errors) / len(errors))

    assert rms(found) < 0.5 * rms(differences[: len(found)])
    assert rms(found) < rms(smooth[: len(found)])


def test_samples_need_not_be_evenly_spaced():
    axis, t, velocity = Windowed(1.0), 0.0, 0.0
    for n in range(200):
        t += 1e-3 * (1 + n % 4)
        velocity = axis.add(t, 700.0 * t)
    assert velocity == pytest.approx(700.0, rel=1e-9)


def test_the_first_sample_and_the_first_after_a_reset_are_at_rest():
    axis = Windowed(1.0)
    assert axis.add(1.0, 500.0) == 0.0
    assert axis.add(1.001, 900.0) == pytest.approx(400_000.0)
    axis.reset()
    assert axis.add(1.002, 0.0) == 0.0
