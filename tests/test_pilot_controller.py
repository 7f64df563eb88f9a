from math import cos, inf, nan, pi, sin, sqrt, tanh

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.pilot.controller import (
    check_gains,
    position_error,
    vehicle_rates,
    velocity_reference,
    world_rates,
)

rates = st.tuples(*[st.floats(-20, 20)] * 4)
angles = st.floats(-10, 10)


def test_equation_3_at_a_yaw_of_90_degrees_turns_forward_into_north() -> None:
    # J(90°) = [[0, -1], [1, 0]] on the plane: forward 2, left 1 → x = −1, y = 2.
    assert world_rates((2.0, 1.0, 0.5, 0.3), pi / 2) == pytest.approx((-1.0, 2.0, 0.5, 0.3))


def test_equation_3_at_a_yaw_of_30_degrees() -> None:
    # x = 2·√3/2 − 1·1/2, y = 2·1/2 + 1·√3/2.
    expected = (sqrt(3) - 0.5, 1 + sqrt(3) / 2, -0.25, 0.0)
    assert world_rates((2.0, 1.0, -0.25, 0.0), pi / 6) == pytest.approx(expected)


@given(rates, angles)
def test_the_inverse_jacobian_undoes_equation_3_and_keeps_lengths(v: tuple, theta: float) -> None:
    p_rate = world_rates(v, theta)
    assert vehicle_rates(p_rate, theta) == pytest.approx(v, abs=1e-9)
    assert p_rate[0] ** 2 + p_rate[1] ** 2 == pytest.approx(v[0] ** 2 + v[1] ** 2, abs=1e-9)


def test_equation_4_worked_by_hand_at_zero_yaw() -> None:
    k1 = (1.2, 0.8, 0.5, 2.0)
    v_ref = velocity_reference((1.0, -0.5, 0.2, 0.1), (0.5, 0.0, -1.0, 0.25), 0.0, k1)
    # tanh 0.5 = 0.46211716, tanh 1 = 0.76159416, tanh 0.25 = 0.24491866
    expected = (1.0 + 1.2 * 0.46211716, -0.5, 0.2 - 0.5 * 0.76159416, 0.1 + 2.0 * 0.24491866)
    assert v_ref == pytest.approx(expected, abs=1e-7)


def test_equation_4_worked_by_hand_at_a_yaw_of_90_degrees() -> None:
    # The error points north, which is ahead of a drone that looks north.
    v_ref = velocity_reference((0.0, 0.0, 0.0, 0.0), (0.0, 0.5, 0.0, 0.0), pi / 2, (1.2, 1.2, 1.2, 1.0))
    assert v_ref == pytest.approx((1.2 * 0.46211716, 0.0, 0.0, 0.0), abs=1e-7)


def test_the_yaw_error_takes_the_shorter_way_across_the_seam() -> None:
    error = position_error((1.0, 2.0, 3.0, pi - 0.1), (0.5, 2.5, 3.0, -pi + 0.2))
    assert error == pytest.approx((0.5, -0.5, 0.0, -0.3))


@given(st.tuples(*[st.floats(-1e3, 1e3)] * 4), rates, angles)
def test_the_correction_is_never_faster_than_its_gain(error: tuple, rate: tuple, theta: float) -> None:
    k1 = (1.2, 1.2, 1.2, 1.0)
    corrected = world_rates(velocity_reference(rate, error, theta, k1), theta)
    for axis in range(4):
        correction = corrected[axis] - rate[axis]
        assert abs(correction) <= k1[axis] + 1e-9
        assert correction == pytest.approx(k1[axis] * tanh(error[axis]), abs=1e-9)


@given(angles)
def test_the_vehicle_axes_are_those_of_the_paper(theta: float) -> None:
    assert world_rates((1.0, 0.0, 0.0, 0.0), theta)[:2] == pytest.approx((cos(theta), sin(theta)))


@pytest.mark.parametrize("gain", [0.0, -1.0, nan, inf])
def test_a_gain_that_is_not_positive_and_finite_is_refused_by_name(gain: float) -> None:
    with pytest.raises(ValueError, match=r"control\.k1\[2\] is .*positive, finite"):
        check_gains("control.k1", (1.0, 1.0, gain, 1.0))
    check_gains("control.k1", (1.0, 1e-3, 5.0, 1.0))
