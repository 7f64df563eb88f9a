"""Identification finds the response that made a flight, and says how sure it is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from identify_support import DT, a_flight, gridded

from groundstation.errors import InputError
from groundstation.identification.bounded import bounded
from groundstation.identification.fit import identify
from groundstation.identification.matrix import each_on_each
from groundstation.identification.refine import normal_at, refined, starts_of, unflat
from groundstation.identification.regress import LEAST, POSITIVE, guessed_delays, regressed
from groundstation.identification.response import CHI, Asked, acted, flown, told, windows
from groundstation.identification.samples import AXES, Raw, on_grid, step_of, unexcited
from groundstation.identification.validate import free_flights, r_squared, validated
from sim.models.dynamic import astuple, respond

DELAY = 0.1


@pytest.fixture(scope="module")
def found_and_chi():
    raw, chi = a_flight(seconds=90.0, delay=DELAY)
    flight = gridded(raw)
    return identify([flight]), flight, chi


def test_chi_comes_back_within_two_percent_out_of_noisy_velocities(found_and_chi):
    found, _, chi = found_and_chi
    assert found.parameters.chi == pytest.approx(chi, rel=0.02)
    assert astuple(found.chi) == tuple(found.parameters.chi)
    assert found.parameters.delays == pytest.approx(DELAY, abs=0.003)
    assert found.condition < 10.0


def test_chi_comes_back_from_what_an_autopilot_believes_in_wind():
    """The estimator lags on world axes and wanders; the wind is steady and the vehicle turns in it."""
    raw, chi = a_flight("x500", delay=0.05, noise=(0.0,) * 4, estimate="rtk", wind=(1.0, -0.5, 0.0))
    found = identify([gridded(raw)])
    assert found.parameters.chi == pytest.approx(chi, rel=0.02)
    # Velocities lag by 0.02 s behind the yaw rate.
    assert found.parameters.delays == pytest.approx([0.07, 0.07, 0.05], abs=0.004)
    assert found.parameters.push[0] == pytest.approx([0.3, -0.15, 0.0], abs=0.02)


def test_the_interval_holds_the_truth_of_most_parameters(found_and_chi):
    found, _, chi = found_and_chi
    inside = (found.low[:CHI] <= chi) & (chi <= found.high[:CHI])
    assert inside.sum() >= CHI - 2
    assert (found.low <= found.high).all()


def test_a_flight_it_has_not_seen_is_told_too(found_and_chi):
    found, flight, _ = found_and_chi
    raw, _ = a_flight(seconds=40.0, delay=DELAY, seed=5)
    for each in (flight, gridded(raw)):
        tells = validated(found.parameters.chi, found.parameters.delays, each)
        assert (tells.free > 0.99).all()
        assert (tells.one_step.model > 0.99).all()
        assert (tells.ahead.model > 0.99).all()
        # What a model is for: half a second on, what was is no guide.
        assert (tells.ahead.nothing < 0.9).all()
        assert (tells.low <= tells.free).all()
        assert (tells.free <= tells.high).all()


def test_another_vehicles_flight_is_told_worse(found_and_chi):
    found, flight, _ = found_and_chi
    raw, _ = a_flight("crazyflie", seconds=40.0, delay=DELAY)
    of = found.parameters
    other, own = (validated(of.chi, of.delays, each).free.min() for each in (gridded(raw), flight))
    assert other < own - 0.01


def test_refining_betters_what_is_held_out(found_and_chi):
    found, _, _ = found_and_chi
    assert found.crossed.mean() > found.crossed_regression.mean()


def test_without_a_delay_the_lateness_is_in_chi(found_and_chi):
    _, flight, chi = found_and_chi
    late = identify([flight], longest_delay=0.0)
    assert (late.parameters.delays == 0.0).all()
    assert (late.parameters.chi[:4] > chi[:4] + 0.5 * DELAY * chi[[4, 7, 8, 9]]).all()


def test_a_share_of_the_flight_tells_less_surely(found_and_chi):
    found, _, _ = found_and_chi
    raw, _ = a_flight(seconds=25.0, delay=DELAY)
    short = identify([gridded(raw)])
    assert (short.high - short.low)[:CHI].mean() > 1.3 * (found.high - found.low)[:CHI].mean()


def test_flights_in_different_winds_count_as_one():
    flights = []
    for seed, wind in enumerate(((2.0, 0.0, 0.0), (0.0, -2.0, 0.0))):
        raw, chi = a_flight(seconds=45.0, wind=wind, seed=seed)
        flights.append(gridded(raw, f"{seed}"))
    found = identify(flights)
    assert found.parameters.chi == pytest.approx(chi, rel=0.03)
    assert found.parameters.push == pytest.approx(np.array([[0.6, 0.0, 0.0], [0.0, -0.6, 0.0]]), abs=0.03)


def test_a_steady_wind_is_told_apart_from_the_vehicle():
    raw, chi = a_flight(seconds=40.0, wind=(2.0, -1.0, 0.5), noise=(0.0,) * 4)
    tells = validated(chi, np.zeros(3), gridded(raw))
    assert tells.free.min() < 0.9
    assert (tells.windy > 0.999).all()
    assert tells.push == pytest.approx([0.6, -0.3, 0.15], abs=0.01)


def test_the_matrix_has_every_pair_and_names_what_is_too_short_alone():
    flights = [gridded(a_flight(seconds=s, seed=k)[0], f"{k}") for k, s in enumerate((30.0, 8.0))]
    matrix = each_on_each(flights, 0.3, lambda _words: None)
    assert [(pair.learned, pair.flight) for pair in matrix.pairs] == [("0", "0"), ("0", "1")]
    assert "1: has" in matrix.alone[0]


def test_too_short_a_flight_is_told():
    raw, _ = a_flight(seconds=7.0)
    with pytest.raises(InputError, match="stretches of"):
        identify([gridded(raw)])


@pytest.mark.parametrize("axis", range(4))
def test_an_axis_that_was_not_asked_for_anything_is_named(axis):
    raw, _ = a_flight(seconds=10.0)
    ref = raw.ref.copy()
    ref[:, axis] = 0.2
    flight = gridded(raw._replace(ref=ref))
    assert unexcited([flight]) == [AXES[axis]]
    with pytest.raises(InputError, match=f"hardly anything was asked of {AXES[axis]}"):
        identify([flight])
    # It is told all the same, by what was learned from another.
    assert validated(np.ones(CHI), np.zeros(3), flight).free.shape == (4,)


@pytest.mark.parametrize(
    "change",
    [
        lambda raw: raw._replace(t=raw.t[::-1]),
        lambda raw: raw._replace(t=np.full_like(raw.t, np.nan)),
        lambda raw: raw._replace(sent=raw.sent[::-1]),
        lambda raw: Raw(raw.t[:1], raw.v[:1], raw.yaw[:1], raw.sent, raw.ref),
    ],
)
def test_times_that_do_not_ascend_are_refused(change):
    raw, _ = a_flight(seconds=10.0)
    with pytest.raises(InputError, match="do not ascend"):
        step_of("flight", change(raw))


@pytest.mark.parametrize("part", ["ref", "v", "yaw"])
def test_a_flight_of_which_a_part_is_never_known_is_refused(part):
    raw, _ = a_flight(seconds=10.0)
    with pytest.raises(InputError, match="references were sent and velocities known"):
        gridded(raw._replace(**{part: np.full_like(getattr(raw, part), np.nan)}))


def test_what_is_not_known_parts_a_flight_in_stretches():
    raw, _ = a_flight(seconds=30.0)
    v = raw.v.copy()
    v[600:640] = np.nan
    samples = gridded(raw._replace(v=v))
    assert [len(stretch.v) for stretch in samples.stretches] == [600, 860]
    assert samples.left_out == pytest.approx(40 * DT, abs=0.3)


def test_only_while_references_were_sent():
    raw, _ = a_flight(seconds=30.0)
    ref = raw.ref.copy()
    ref[:300] = np.nan
    ref[1000:1003] = np.nan
    parts = gridded(raw._replace(ref=ref)).stretches
    assert [len(stretch.v) for stretch in parts] == pytest.approx([701, 497], abs=1)
    assert parts[0].ref[0] == pytest.approx(raw.ref[300])


def test_a_step_of_the_grid_has_the_mean_of_what_was_asked_in_it():
    """References at 50 Hz, velocities at 30 Hz: nothing of them is lost."""
    raw, _ = a_flight(seconds=10.0)
    t = np.arange(0.0, 9.9, 1.0 / 30.0)
    (stretch,) = on_grid(
        "flight", raw._replace(t=t, v=np.zeros((len(t), 4)), yaw=t * 0.0), 1.0 / 30.0
    ).stretches
    held = np.repeat(raw.ref, 100, axis=0)
    wanted = held[: len(held) // 500 * 500].reshape(-1, 500, 4).mean(axis=1)
    found = stretch.ref[: len(stretch.ref) // 3 * 3].reshape(-1, 3, 4).mean(axis=1)
    assert found == pytest.approx(wanted[: len(found)], abs=2e-3)


def test_the_model_flown_is_the_simulators_own():
    raw, chi = a_flight(seconds=8.0, noise=(0.0,) * 4)
    ref, yaw = raw.ref[:, None], np.zeros((len(raw.t), 1))
    push = np.array([[0.3, 0.1, -0.2]])
    way = flown(Asked(ref, yaw, DT), raw.v[:1], chi, push)[:, 0]
    p, v = (0.0,) * 4, tuple(raw.v[0])
    for k in range(6):
        assert tuple(way[k]) == pytest.approx(v, abs=1e-12)
        _, v = respond((*p[:3], 0.0), v, tuple(ref[k, 0]), tuple(push[0]), (tuple(chi), 1.0, DT))


def test_a_free_flight_is_given_nothing_but_the_first_velocity():
    raw, chi = a_flight(seconds=20.0, noise=(0.0,) * 4)
    flight = gridded(raw)
    ((_, way),) = free_flights(chi, np.zeros(3), flight)
    spoilt = raw.v.copy()
    spoilt[1:] += 1.0
    ((_, again),) = free_flights(chi, np.zeros(3), gridded(raw._replace(v=spoilt)))
    assert again == pytest.approx(way)


@given(st.floats(0.0, 0.3), st.floats(0.0, 0.3), st.floats(0.0, 0.3))
def test_what_is_told_comes_back_as_it_acted(level, up, yaw_rate):
    raw, _ = _CALM_FLIGHT
    delays = np.array([level, up, yaw_rate])
    v, yaw = raw.v[:, None], raw.yaw[:, None]
    back = acted(told(v, yaw, delays, DT), yaw, delays, DT)
    assert back[40:-40] == pytest.approx(v[40:-40], abs=2e-3)


_CALM_FLIGHT = a_flight(seconds=6.0, noise=(0.0,) * 4)


@given(st.integers(0, 2**32 - 1))
def test_the_bounded_solution_satisfies_its_optimality_conditions(seed):
    """Karush, Kuhn and Tucker: no slope along what is free, and none inwards from what lies on its bound."""
    random = np.random.default_rng(seed)
    k = int(random.integers(1, 14))
    matrix, wanted = random.normal(size=(30, k)), random.normal(size=30)
    low = np.where(random.random(k) < 0.6, random.normal(0.0, 0.3, k), -np.inf)
    squares, slopes = matrix.T @ matrix, matrix.T @ wanted
    x = bounded(squares, slopes, low)
    slope = squares @ x - slopes
    assert (x >= low - 1e-12).all()
    on_bound = x <= low + 1e-12
    assert slope[~on_bound] == pytest.approx(0.0, abs=1e-7)
    assert (slope[on_bound] >= -1e-7).all()


def test_the_refined_estimate_satisfies_them_too_where_a_bound_holds_it():
    """A vehicle that is quicker than inertia may be: its inertia lies on the bound, and downhill is beyond it."""
    raw, _ = a_flight(seconds=40.0, noise=(0.0,) * 4)
    v = raw.v.copy()
    v[:, 3] = raw.ref[:, 3]
    pieces = windows([gridded(raw._replace(v=v))], 2.5, 0.1)
    delays = guessed_delays(pieces, 0.0)
    first = regressed(pieces, delays, 0.0)
    found = refined(pieces, unflat(np.concatenate((first, delays, np.zeros(3)))), 0.0)
    assert found.chi[3] == LEAST
    normal = normal_at(pieces, found)
    downhill, sizes = normal.slopes.sum(axis=0), np.sqrt(np.diagonal(normal.squares.sum(axis=0)))
    assert downhill[3] < 0.0
    free = np.ones(len(downhill), bool)
    free[:CHI][POSITIVE & (found.chi <= LEAST)] = False
    free[CHI : CHI + 3] = found.delays > 0.0
    left = np.sqrt(normal.left.sum())
    assert np.abs(downhill[free] / np.maximum(sizes[free], 1e-9)).max() < 1e-3 * left


def test_each_window_starts_where_its_references_acted():
    raw, _ = a_flight(seconds=20.0, delay=DELAY, noise=(0.0,) * 4)
    pieces = windows([gridded(raw)], 2.5, 0.5)
    shift = round(DELAY / DT)
    starts = starts_of(pieces, np.full(3, DELAY))
    assert starts == pytest.approx(pieces.v[shift], abs=1e-6)


@given(arrays(float, (20, 4), elements=st.floats(-10, 10)))
def test_a_perfect_tale_has_r_squared_of_one_and_of_what_is_still_there_is_none(v):
    scores = r_squared(v, v)
    still = v.std(axis=0) < 0.03
    assert scores[~still] == pytest.approx(1.0)
    assert np.isnan(scores[still & (v.std(axis=0) < 0.0299)]).all()
