"""The signals of an excitation: no mean, bounded, little crest, lines that no two axes share."""

from __future__ import annotations

import math

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.config import Limits, Mapping, Settings
from groundstation.errors import InputError
from groundstation.identification.excitation import FADE_S, Excitation, foreseen, plan
from groundstation.identification.multisine import Multisine, lines_within, multisine

LINES = st.lists(st.integers(1, 40), min_size=1, max_size=20, unique=True)
PERIODS = st.floats(5.0, 100.0)
SEEDS = st.integers(0, 1000)


def sampled(signal: Multisine, count: int = 701) -> tuple[np.ndarray, np.ndarray]:
    """Return way and velocity over a period, at an odd number of places that no peak is looked for at."""
    rows = [signal.at(float(t)) for t in np.arange(count) * (signal.period / count)]
    way, velocity = np.array(rows).T
    return way, velocity


@given(LINES, PERIODS, SEEDS)
@settings(max_examples=60, deadline=None)
def test_over_a_period_it_has_no_mean_and_stays_within_its_peaks(lines, period, seed):
    signal = multisine(lines, period, seed)
    way, velocity = sampled(signal)
    peaks = signal.peaks()
    assert peaks.velocity == pytest.approx(1.0)
    assert abs(velocity.mean()) < 1e-9
    assert abs(way.mean()) < 1e-9 * max(1.0, peaks.way)
    assert np.abs(velocity).max() <= 1.0
    assert np.abs(way).max() <= peaks.way
    # A bound that is far above what it bounds would cost amplitude.
    assert np.abs(velocity).max() > 0.95
    assert np.abs(way).max() > 0.95 * peaks.way


@given(LINES, PERIODS, SEEDS)
@settings(max_examples=30, deadline=None)
def test_the_velocity_is_the_way_s_derivative(lines, period, seed):
    signal = multisine(lines, period, seed)
    t, h = 0.3 * period, 1e-5 * period / max(lines)
    (before, _), (after, _) = signal.at(t - h), signal.at(t + h)
    assert signal.at(t)[1] == pytest.approx((after - before) / (2 * h), abs=1e-6)


@given(LINES, PERIODS, SEEDS)
@settings(max_examples=30, deadline=None)
def test_its_spectrum_is_flat_on_its_lines_and_empty_beside_them(lines, period, seed):
    _, velocity = sampled(multisine(lines, period, seed))
    spectrum = np.abs(np.fft.rfft(velocity))
    on = spectrum[sorted(lines)]
    npt.assert_allclose(on, on[0], rtol=1e-9)
    assert np.delete(spectrum, sorted(lines)).max() < 1e-9 * on[0]


def crest(signal):
    """Return the velocity's peak, as it is bounded, by its root mean square."""
    rms = math.sqrt(0.5 * np.square(signal.amplitudes * math.tau * signal.frequencies).sum())
    return signal.peaks().velocity / rms


@given(st.lists(st.integers(1, 40), min_size=4, max_size=20, unique=True), SEEDS)
@settings(max_examples=40, deadline=None)
def test_its_crest_is_little(lines, seed):
    """All phases alike would have a crest of √(2 k): 2.8 of 4 lines, 6.3 of 20."""
    assert crest(multisine(range(2, 2 + len(lines)), 20.0, seed)) < 2.05
    signal = multisine(lines, 20.0, seed)
    assert crest(signal) < min(2.7, 0.97 * math.sqrt(2 * len(lines)))
    peak, rms = np.abs(sampled(signal)[1]).max(), np.sqrt(np.square(sampled(signal)[1]).mean())
    assert peak / rms == pytest.approx(crest(signal), rel=0.05)


def test_the_same_seed_makes_the_same():
    one, other = multisine([2, 3, 5], 20.0, 7), multisine([5, 3, 2], 20.0, 7)
    npt.assert_array_equal(one.phases, other.phases)


def test_lines_lie_within_the_band_with_its_ends():
    assert list(lines_within(0.1, 0.3, 20.0)) == [2, 3, 4, 5, 6]
    assert list(lines_within(0.01, 0.1, 20.0)) == [1, 2]


SETTINGS = st.builds(
    lambda horizontal, vertical, turn, acceleration, jerk: Settings(
        limits=Limits(
            horizontal_speed=horizontal,
            vertical_speed=vertical,
            yaw_rate=turn,
            acceleration=acceleration,
            jerk=jerk,
            yaw_acceleration=acceleration,
            yaw_jerk=jerk,
        ),
        mapping=Mapping(),
    ),
    st.floats(0.2, 5.0),
    st.floats(0.2, 3.0),
    st.floats(0.2, 2.0),
    st.floats(0.5, 6.0),
    st.floats(2.0, 60.0),
)
AXES = st.lists(st.integers(0, 3), min_size=1, max_size=4, unique=True).map(sorted)


@given(AXES, st.floats(0.05, 1.0), st.floats(15.0, 40.0), SETTINGS)
@settings(max_examples=25, deadline=None)
def test_an_excitation_stays_within_what_it_says_and_the_limits(axes, share, seconds, chosen):
    found = plan(axes, share, seconds, (0.1, 1.0), chosen)
    limits, speeds = chosen.limits, chosen.mapping.speed
    times = np.linspace(-1.0, found.duration + 1.0, 1500)
    rows = np.array([found.at(float(t)) for t in times])
    way, velocity = np.abs(rows[:, 0]).max(axis=0), np.abs(rows[:, 1]).max(axis=0)
    assert (way <= np.array(found.furthest()) + 1e-12).all()
    assert (velocity <= np.array(found.fastest()) + 1e-12).all()
    by_axis = (limits.horizontal_speed, limits.horizontal_speed, limits.vertical_speed, limits.yaw_rate)
    for stretch in found.stretches:
        for axis, signal in enumerate(stretch.signals):
            if signal:
                peaks = signal.peaks()
                most = min(1.0, 2 * share) if axis == 3 else share
                assert peaks.velocity <= most * min(speeds[axis], by_axis[axis]) * (1 + 1e-9)
                assert peaks.acceleration <= limits.acceleration
                assert peaks.jerk <= limits.jerk
    # What is not excited rests.
    assert not rows[:, :, [axis for axis in range(4) if axis not in axes]].any()


@given(AXES, st.floats(15.0, 40.0))
@settings(max_examples=20, deadline=None)
def test_every_stretch_begins_and_ends_at_rest_at_the_start(axes, seconds):
    found = plan(axes, 0.5, seconds, (0.1, 1.0), Settings())
    for stretch in found.stretches:
        for t in (stretch.start, stretch.start + 1e-7, stretch.end - 1e-7, stretch.end):
            npt.assert_allclose(found.at(t), 0.0, atol=1e-5)
        excited = sum(signal is not None for signal in stretch.signals)
        assert stretch.end - stretch.start == pytest.approx(seconds * min(excited, 2) + 2 * FADE_S)


def test_one_axis_after_the_other_then_all_at_once_on_lines_of_their_own():
    found = plan((0, 1, 2, 3), 0.5, 20.0, (0.1, 1.0), Settings())
    excited = [[axis for axis, signal in enumerate(stretch.signals) if signal] for stretch in found.stretches]
    assert excited == [[0], [1], [2], [3], [0, 1, 2, 3]]
    together = [set(signal.lines.tolist()) for signal in found.stretches[-1].signals]
    assert set.union(*together) == set(range(4, 41))
    assert sum(map(len, together)) == 37
    assert found.duration == pytest.approx(4 * 24.0 + 44.0 + 4 * 2.0)


def test_the_velocity_integrates_to_the_way():
    found = plan((0, 1), 0.5, 15.0, (0.1, 1.0), Settings())
    times = np.arange(0.0, found.duration, 0.002)
    rows = np.array([found.at(float(t)) for t in times])
    npt.assert_allclose(np.cumsum(rows[:, 1], axis=0) * 0.002, rows[:, 0], atol=2e-3)


def test_a_band_with_too_few_lines_is_refused():
    with pytest.raises(InputError, match="2 lines in 10 s, and 3 an axis"):
        plan((0,), 0.5, 10.0, (0.1, 0.2), Settings())
    with pytest.raises(InputError, match="9 lines in 20 s, and 3 an axis"):
        plan((0, 1, 2, 3), 0.5, 10.0, (0.1, 0.5), Settings())


def test_the_vehicle_is_predicted_where_a_vehicle_of_that_response_comes():
    """Against the solution for one sine: x / x_h = G (s + k) / (s + k G), with G = g e^(−ds) / (1 + τ s)."""
    lone = multisine([4], 20.0, 0).scaled(0.1)
    found = Excitation(plan((0,), 0.5, 20.0, (0.1, 1.0), Settings()).stretches)
    found = Excitation((found.stretches[0]._replace(signals=(lone, None, None, None)),))
    g, tau, k, d = 1.5, 0.8, 0.6, 0.15
    s = 1j * math.tau * 0.2
    response = g * np.exp(-d * s) / (1 + tau * s)
    expected = abs(response * (s + k) / (s + k * response)) * lone.peaks().way
    ahead = foreseen(found, [(g, tau)], k, d)
    assert ahead.distance[:, 0].max() == pytest.approx(expected, rel=0.06)
    both = foreseen(found, [(g, tau), (0.5, tau)], k, d)
    npt.assert_array_equal(both.distance.max(), ahead.distance.max())
    assert (both.speed >= ahead.speed).all()
