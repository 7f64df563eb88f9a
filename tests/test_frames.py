"""Frames convert there and back, and by hand where it can be checked by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation import frames

angles = st.floats(-50, 50)
lengths = st.floats(-1e4, 1e4)


@given(angles)
def test_wrapped_angles_are_the_same_direction_within_half_a_turn(angle):
    wrapped = frames.wrap(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.isclose(math.cos(wrapped), math.cos(angle), abs_tol=1e-9)
    assert math.isclose(math.sin(wrapped), math.sin(angle), abs_tol=1e-9)


@given(st.tuples(lengths, lengths, lengths))
def test_ned_and_enu_are_each_others_inverse(vector):
    assert frames.enu_from_ned(frames.enu_from_ned(vector)) == vector


@given(st.tuples(lengths, lengths, lengths, lengths))
def test_flu_and_frd_are_each_others_inverse(velocity):
    assert frames.frd_from_flu(frames.frd_from_flu(velocity)) == velocity


@pytest.mark.parametrize(
    ("heading_deg", "yaw"),
    [(0, math.pi / 2), (90, 0), (180, -math.pi / 2), (270, math.pi), (45, math.pi / 4)],
)
def test_headings_by_hand(heading_deg, yaw):
    assert math.isclose(frames.yaw_from_heading(heading_deg), yaw, abs_tol=1e-12)
    assert math.isclose(frames.heading_from_yaw(yaw), heading_deg, abs_tol=1e-9)


def test_a_vehicle_facing_north_sees_north_as_forward():
    forward, left, up = frames.body_from_world((0.0, 2.0, 1.0), math.pi / 2)
    assert forward == pytest.approx(2.0)
    assert left == pytest.approx(0.0, abs=1e-12)
    assert up == 1.0


@given(st.tuples(lengths, lengths, lengths), angles)
def test_turning_keeps_lengths(vector, yaw):
    assert math.isclose(math.hypot(*frames.body_from_world(vector, yaw)), math.hypot(*vector), rel_tol=1e-9)


@pytest.mark.parametrize(
    ("bearing_deg", "angle"), [(0, 0), (90, -math.pi / 2), (-90, math.pi / 2), (180, math.pi), (720, 0)]
)
def test_bearings_by_hand(bearing_deg, angle):
    assert math.isclose(frames.angle_from_bearing(bearing_deg), angle, abs_tol=1e-12)
