"""Turbulence: its spread and spectrum are the standard's, whatever the step."""

import functools
import itertools
import math
from random import Random

import numpy as np
import pytest

from sim.environment.turbulence import _MIX, Dryden, Turbulence, low_altitude

RATES = (0.004, 0.04)


class Impulses:
    """Noise that is zero but for one draw, to read a linear filter's coefficients off it."""

    def __init__(self, at):
        self.at, self.count = at, -1

    def gauss(self, mean, deviation):
        self.count += 1
        return float(self.count == self.at)


def transverse_step(r):
    """Return what one step does to the transverse pair and the covariance of the noise it adds."""
    field = Dryden(Impulses(-1))
    transition = np.array([field._advanced(tuple(unit), r) for unit in np.eye(2)]).T
    noise = []
    for draw in range(2):
        field._gauss = Impulses(draw).gauss
        noise.append(field._advanced((0.0, 0.0), r))
    noise = np.array(noise).T
    return transition, noise @ noise.T


@pytest.mark.parametrize("r", [1e-7, 1e-5, 5e-4, 9.9e-4, 1.1e-3, 0.03, 1.0, 40.0])
def test_two_steps_are_one_of_twice_the_length_and_the_long_run_is_kept(r):
    """The mark of an exact discretisation; the long-run covariance is [[1, ½], [½, ½]]."""
    once, added = transverse_step(r)
    twice, added_twice = transverse_step(2.0 * r)
    assert once @ once == pytest.approx(twice, rel=1e-9, abs=1e-15)
    size = np.sqrt(np.outer(np.diag(added_twice), np.diag(added_twice)))
    assert (once @ added @ once.T + added) / size == pytest.approx(
        added_twice / size, abs=2e-3 if r < 2e-3 else 1e-6
    )
    long_run = np.array([[1.0, 0.5], [0.5, 0.5]])
    assert once @ long_run @ once.T + added == pytest.approx(long_run, abs=1e-9)


def test_low_altitude_is_the_standard():
    """MIL-F-8785C at 20 ft and at 1000 ft, where the scale is 1000 ft and turbulence is isotropic."""
    level, upward, ratio = low_altitude(20 * 0.3048)
    assert level == pytest.approx(20 * 0.3048 / (0.177 + 0.000823 * 20) ** 1.2)
    assert upward == pytest.approx(20 * 0.3048)
    assert ratio == pytest.approx((0.177 + 0.000823 * 20) ** -0.4)
    assert low_altitude(304.8) == pytest.approx((304.8, 304.8, 1.0))
    assert low_altitude(5000.0) == pytest.approx(low_altitude(304.8))
    assert low_altitude(-1.0) == low_altitude(0.0) == low_altitude(3.048)


@functools.cache
def flown(model, dt, seconds=1640.0, height=6.0, airspeed=10.0, intensity=1.5, seed=3):
    """Return the turbulence along a flight, shape (n, 3)."""
    turbulence = Turbulence(model, Random(seed))
    return np.array([turbulence.step(height, airspeed, intensity, dt) for _ in range(round(seconds / dt))])


@pytest.mark.parametrize(("model", "dt"), list(itertools.product(_MIX, RATES)))
def test_the_spread_is_the_standards_at_any_step(model, dt):
    gusts = flown(model, dt)
    ratio = low_altitude(6.0)[2]
    assert np.std(gusts, axis=0) == pytest.approx((1.5 * ratio, 1.5 * ratio, 1.5), rel=0.12)
    assert np.abs(np.corrcoef(gusts.T)[np.triu_indices(3, 1)]).max() < 0.15


def dryden(t):
    return 2.0 * t, lambda x: 1.0 / (1.0 + x**2), lambda x: 0.5 * (1.0 + 3.0 * x**2) / (1.0 + x**2) ** 2


def von_karman(t):
    return (
        2.0 * t,
        lambda x: (1.0 + (1.339 * x) ** 2) ** (-5 / 6),
        lambda x: 0.5 * (1.0 + 8 / 3 * (1.339 * x) ** 2) / (1.0 + (1.339 * x) ** 2) ** (11 / 6),
    )


SHAPES = {"dryden": dryden, "von_karman": von_karman}


@pytest.mark.parametrize("model", _MIX)
def test_the_mix_has_the_models_spectrum(model):
    """By the filters' own equations, along and across, over three and a half decades."""
    x = np.logspace(math.log10(0.02), math.log10(75.0), 200)
    _, along, across = SHAPES[model](1.0)
    mixed_along = sum(share * scale / (1 + (scale * x) ** 2) for scale, share in _MIX[model])
    mixed_across = sum(
        share * scale * 0.5 * (1 + 3 * (scale * x) ** 2) / (1 + (scale * x) ** 2) ** 2
        for scale, share in _MIX[model]
    )
    assert mixed_along / along(x) == pytest.approx(1.0, abs=0.025)
    assert mixed_across / across(x) == pytest.approx(1.0, abs=0.04)
    assert sum(share for _, share in _MIX[model]) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize(("model", "dt"), list(itertools.product(_MIX, RATES)))
def test_the_spectrum_is_the_models_at_any_step(model, dt):
    """Periodograms averaged by octave against Φ(ω) = σ²/π · 2T · shape(ωT), where sampling does not fold it."""
    gusts = flown(model, dt)
    airspeed = math.hypot(10.0, 1.5)
    pieces = int(len(gusts) * dt / 82.0)
    rows = len(gusts) // pieces
    level, upward, ratio = low_altitude(6.0)
    window = np.hanning(rows)[:, None]
    power = np.zeros((rows // 2 + 1, 3))
    for piece in range(pieces):
        part = gusts[piece * rows : (piece + 1) * rows]
        power += np.abs(np.fft.rfft(window * part, axis=0)) ** 2
    power *= 2.0 * dt / (pieces * np.sum(window**2))  # one-sided, per Hz
    f = np.fft.rfftfreq(rows, dt)
    for axis, (scale, sigma, shape) in enumerate(
        ((level, 1.5 * ratio, 1), (level, 1.5 * ratio, 2), (upward, 1.5, 2))
    ):
        twice, *shapes = SHAPES[model](scale / airspeed)
        expected = 2.0 * sigma**2 * twice * shapes[shape - 1](math.tau * f * scale / airspeed)
        for octave in range(7):
            band = (f >= 0.05 * 2**octave) & (f < 0.1 * 2**octave) & (f < 0.2 / dt)
            if band.any():
                assert np.mean(power[band, axis]) == pytest.approx(np.mean(expected[band]), rel=0.35)


def test_in_calm_air_at_hover_turbulence_still_comes_and_goes():
    gusts = flown("dryden", 0.1, seconds=20_000.0, airspeed=0.0, intensity=0.5)
    assert np.all(np.isfinite(gusts))
    assert np.std(gusts, axis=0) == pytest.approx((0.5 * low_altitude(6.0)[2],) * 2 + (0.5,), rel=0.25)
    assert math.dist(gusts[0], gusts[1]) < 0.5


@pytest.mark.parametrize("model", _MIX)
def test_a_changing_airspeed_does_not_change_the_spread(model):
    turbulence = Turbulence(model, Random(5))
    up = [turbulence.step(6.0, 30.0 if number % 50 < 25 else 0.5, 1.0, 0.05)[2] for number in range(60_000)]
    assert np.std(up) == pytest.approx(1.0, rel=0.1)
