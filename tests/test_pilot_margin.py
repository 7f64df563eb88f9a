from itertools import pairwise
from math import atan, degrees, exp, inf, isinf, pi, radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.config import Control, Link
from groundstation.pilot.link_state import link_fault, shares
from groundstation.pilot.margin import (
    COMPENSATED,
    USUAL_LAGS,
    Lag,
    lags_of,
    largest_gain,
    loop_for,
    phase_margin,
)
from sim.airframe import load_airframe

CONTROL = Control()


def test_without_a_lag_the_rule_is_k_times_d_below_a_right_angle() -> None:
    assert phase_margin(1.0, 0.5, Lag(1.0, 0.0)) == pytest.approx(pi / 2 - 0.5)
    assert largest_gain(0.0, 0.5, Lag(1.0, 0.0)) == pytest.approx(pi)
    assert largest_gain(pi / 4, 0.5, Lag(2.0, 0.0)) == pytest.approx(pi / 4)
    assert isinf(largest_gain(0.5, 0.0, Lag(1.0, 0.0)))


def test_a_lag_alone_takes_its_phase() -> None:
    # ω = 1: k = √2, and atan(1) = 45° is gone.
    assert phase_margin(2**0.5, 0.0, Lag(1.0, 1.0)) == pytest.approx(pi / 2 - atan(1.0))


@given(st.floats(0.1, 1.4), st.floats(0.0, 1.5), st.builds(Lag, st.floats(0.3, 3), st.floats(0.01, 2)))
def test_the_largest_gain_leaves_just_its_margin(margin: float, delay: float, lag: Lag) -> None:
    assert phase_margin(largest_gain(margin, delay, lag), delay, lag) == pytest.approx(margin, abs=1e-6)


def loop(delay: float, lags=USUAL_LAGS):
    return loop_for(delay, CONTROL.k1, CONTROL.k3, radians(CONTROL.phase_margin_deg), lags)


@pytest.mark.parametrize("lags", [USUAL_LAGS, COMPENSATED, lags_of(load_airframe("matrice_100").chi)])
def test_gains_fall_with_the_delay_and_the_margin_is_kept(lags) -> None:
    loops = [loop(delay, lags) for delay in (0.0, 0.1, 0.3, 0.7, 1.2)]
    assert all(a >= b for one, other in pairwise(loops) for a, b in zip(one.k1, other.k1, strict=True))
    assert all(degrees(each.margin) >= CONTROL.phase_margin_deg - 1e-3 for each in loops)
    assert all(gain <= set_ for each in loops for gain, set_ in zip(each.k1, CONTROL.k1, strict=True))
    assert loops[-1].k1[0] < CONTROL.k1[0]


def test_the_plane_has_one_gain_as_the_vehicle_turns_in_it() -> None:
    k1 = loop(0.3, lags_of(load_airframe("matrice_100").chi)).k1
    assert k1[0] == k1[1] < CONTROL.k1[0]


@pytest.mark.parametrize("delay", [0.1, 0.3, 0.7])
def test_the_loop_with_that_gain_settles_and_far_beyond_it_does_not(delay: float) -> None:
    """The linear loop ṗ = v, τ v̇ = g k (−p(t − d)) − v, in time."""
    lag = Lag(1.68, 1.14)

    def swing(gain: float) -> float:
        dt, p, v = 0.002, 1.0, 0.0
        past = [p] * round(delay / dt)
        late: list[float] = []
        for tick in range(round(60.0 / dt)):
            past.append(p)
            v += (1 - exp(-dt / lag.time)) * (-lag.gain * gain * past[-1 - round(delay / dt)] - v)
            p += v * dt
            if tick * dt > 50.0:
                late.append(abs(p))
        return max(late)

    gain = largest_gain(radians(45), delay, lag)
    assert swing(gain) < 0.01
    assert swing(25.0 * gain) > 1.0


def test_a_good_link_leaves_all_and_a_poor_one_the_least() -> None:
    link = Link()
    assert shares(0.1, 0.0, link) == (1.0, 1.0)
    assert shares(float("nan"), 0.0, link) == (1.0, 1.0)
    assert shares(0.9, 0.0, link) == pytest.approx((link.least_gain, link.least_speed))
    assert shares(0.0, 0.5, link) == pytest.approx((link.least_gain, link.least_speed))
    assert shares(0.5, 0.0, link) == pytest.approx(
        (0.5 * (1 + link.least_gain), 0.5 * (1 + link.least_speed))
    )


def test_too_poor_a_link_is_no_link_to_fly_by() -> None:
    link = Link()
    assert not link_fault(float("nan"), 0.0, link)
    assert not link_fault(1.1, 0.6, link)
    assert link_fault(1.25, 0.0, link) == "the round trip of 1.2 s is too long to fly by hand"
    assert link_fault(0.1, 0.8, link) == "80% of the vehicle's frames are lost"
    assert link_fault(inf, 0.0, link)


@given(st.floats(0, 3), st.floats(0, 1), st.floats(0, 3), st.floats(0, 1))
def test_a_worse_link_never_leaves_more(delay: float, loss: float, more: float, lost: float) -> None:
    better = shares(delay, loss, Link())
    worse = shares(delay + more, min(1.0, loss + lost), Link())
    assert worse.gain <= better.gain
    assert worse.speed <= better.speed


def test_thresholds_that_do_not_rise_are_refused() -> None:
    with pytest.raises(ValueError, match="good_delay_s, poor_delay_s, hold_delay_s must rise"):
        Link(good_delay_s=0.9)
