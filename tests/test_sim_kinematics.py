"""Equations (1) to (3)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.kinematics import advance, vehicle_rates, world_rates, wrap

ANGLES = st.floats(-10, 10)
RATES = st.tuples(*[st.floats(-50, 50)] * 4)


@given(ANGLES, RATES)
def test_the_inverse_undoes_the_jacobian(theta, v):
    assert vehicle_rates(theta, world_rates(theta, v)) == pytest.approx(v, abs=1e-12)
    assert world_rates(theta, vehicle_rates(theta, v)) == pytest.approx(v, abs=1e-12)


@given(ANGLES, RATES)
def test_turning_changes_no_speed(theta, v):
    x, y, z, rate = world_rates(theta, v)
    assert math.hypot(x, y) == pytest.approx(math.hypot(v[0], v[1]), abs=1e-12)
    assert (z, rate) == v[2:]


@pytest.mark.parametrize(
    ("theta", "forward", "left"),
    [
        (0.0, (1, 0), (0, 1)),
        (math.pi / 2, (0, 1), (-1, 0)),
        (math.pi, (-1, 0), (0, -1)),
        (-math.pi / 2, (0, -1), (1, 0)),
    ],
)
def test_forward_and_left_point_where_the_yaw_says(theta, forward, left):
    assert world_rates(theta, (1.0, 0.0, 0.0, 0.0))[:2] == pytest.approx(forward, abs=1e-15)
    assert world_rates(theta, (0.0, 1.0, 0.0, 0.0))[:2] == pytest.approx(left, abs=1e-15)


def test_a_step_adds_the_rates():
    assert advance((1.0, 2.0, 3.0, math.pi / 2), (0.5, 0.25, -1.0, 0.1), 0.2) == pytest.approx(
        (1.0 - 0.05, 2.0 + 0.1, 2.8, math.pi / 2 + 0.02)
    )


@given(st.floats(-1e4, 1e4))
def test_wrapped_angles_are_the_same_and_small(angle):
    wrapped = wrap(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.isclose(math.cos(wrapped), math.cos(angle), abs_tol=1e-9)
    assert math.isclose(math.sin(wrapped), math.sin(angle), abs_tol=1e-9)


def test_half_a_turn_stays_positive():
    assert wrap(math.pi) == math.pi
    assert wrap(-math.pi) == math.pi
