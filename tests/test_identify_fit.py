"""Identification finds the response that made a flight, and says how sure it is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from identify_support import a_flight

from groundstation.errors import InputError
from groundstation.identification.fit import identify, told
from groundstation.identification.regress import LEAST, bounded
from groundstation.identification.response import CHI, flown, r_squared, windows
from groundstation.identification.samples import Raw, on_grid
from sim.models.dynamic import astuple, respond


@pytest.fixture(scope="module")
def found_and_chi():
    raw, chi = a_flight(seconds=60.0, delay=0.1)
    flight = on_grid("flight", raw)
    return identify([flight]), flight, chi


def test_chi_comes_back_within_two_percent_out_of_noisy_velocities(found_and_chi):
    found, _, chi = found_and_chi
    assert found.parameters[:CHI] == pytest.approx(chi, rel=0.02)
    assert astuple(found.chi) == tuple(found.parameters[:CHI])
    assert found.delay == pytest.approx(0.1, abs=0.005)
    assert found.condition < 100.0


def test_the_interval_holds_the_truth_of_most_parameters(found_and_chi):
    found, _, chi = found_and_chi
    inside = (found.low[:CHI] <= chi) & (chi <= found.high[:CHI])
    assert inside.sum() >= CHI - 2
    assert (found.low <= found.high).all()


def test_a_flight_it_has_not_seen_is_told_too(found_and_chi):
    found, flight, _ = found_and_chi
    raw, _ = a_flight(seconds=40.0, delay=0.1, seed=5)
    for each in (flight, on_grid("other", raw)):
        tells = told(found, each)
        assert (tells.free > 0.99).all()
        assert (tells.one_step > 0.99).all()
        assert (tells.ahead > 0.99).all()


def test_another_vehicles_flight_is_told_worse(found_and_chi):
    found, flight, _ = found_and_chi
    raw, _ = a_flight("crazyflie", seconds=40.0, delay=0.1)
    assert told(found, on_grid("crazyflie", raw)).free.min() < told(found, flight).free.min()


def test_too_short_a_flight_is_told():
    raw, _ = a_flight(seconds=7.0)
    with pytest.raises(InputError, match="stretches of"):
        identify([on_grid("short", raw)])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda raw: raw._replace(t=raw.t[::-1]), "do not ascend"),
        (lambda raw: raw._replace(t=np.full_like(raw.t, np.nan)), "do not ascend"),
        (lambda raw: raw._replace(ref=np.full_like(raw.ref, np.nan)), "references were sent"),
        (lambda raw: raw._replace(ref=raw.ref * (1, 1, 1, 0)), "asked of yaw rate"),
        (lambda raw: Raw(raw.t[:1], raw.v[:1], raw.ref[:1]), "do not ascend"),
    ],
)
def test_what_tells_nothing_is_refused_in_a_sentence(change, words):
    raw, _ = a_flight(seconds=10.0)
    with pytest.raises(InputError, match=words):
        on_grid("flight", change(raw))


def test_what_is_not_known_parts_a_flight_in_stretches():
    raw, _ = a_flight(seconds=30.0)
    v = raw.v.copy()
    v[600:640] = np.nan
    parts = on_grid("flight", raw._replace(v=v)).stretches
    assert [len(each) for each, _ in parts] == [600, 860]


def test_the_model_flown_is_the_simulators_own():
    raw, chi = a_flight(seconds=8.0, noise=(0.0,) * 4)
    flight = on_grid("flight", raw)
    whole = windows(flight, flight.seconds - flight.dt, 0.0)
    way = flown(whole, np.concatenate((chi, np.zeros(3))))[:, 0]
    p, v = (0.0,) * 4, tuple(raw.v[0])
    for k in range(5):
        assert tuple(way[k]) == pytest.approx(v, abs=1e-9)
        p, v = respond(p, v, tuple(raw.ref[k]), (0.0, 0.0, 0.0), (tuple(chi), 0.0, flight.dt))


@given(st.integers(0, 2**32 - 1), st.booleans(), st.floats(0.0, 0.1))
def test_the_bounded_solution_satisfies_its_optimality_conditions(seed, pull, ridge):
    """Karush, Kuhn and Tucker: no slope along what is free, and none inwards from what lies on its bound."""
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(30, 3))
    wanted = matrix @ np.array([-0.5 if pull else 0.4, 0.8, -0.3]) + random.normal(0.0, 0.1, 30)
    prior, positive = np.array([0.5, 1.0, 0.0]), np.array([True, True, False])
    x = bounded(matrix, wanted, prior, ridge, positive)
    weight = ridge * np.trace(matrix.T @ matrix) / 3
    slope = matrix.T @ (matrix @ x - wanted) + weight * (x - prior)
    assert (x[positive] >= LEAST).all()
    on_bound = positive & (x <= LEAST + 1e-12)
    assert slope[~on_bound] == pytest.approx(0.0, abs=1e-6)
    assert (slope[on_bound] >= -1e-6).all()


@given(arrays(float, (20, 4), elements=st.floats(-10, 10)))
def test_a_perfect_tale_has_r_squared_of_one(v):
    assert (r_squared(v, v) <= 1.0).all()
    assert r_squared(v, v) == pytest.approx(1.0)
