"""The rigid body as a model of motion: what the simulator gives and takes, and its attitude."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.airframe import MODELS, load_airframe
from sim.kinematics import ZERO3, ZERO4, wrap
from sim.models.motion import GRAVITY

DT = 0.004
HIGH = (3.0, -2.0, 40.0, 0.9)
YAW = st.floats(-3.1, 3.1)


def hovering(p=HIGH, name="x500"):
    motion = MODELS["rigid_body"](load_airframe(name))
    return motion, *motion.hover(p)


def flown(motion, p, v, v_ref, seconds, wind=ZERO3):
    for _ in range(round(seconds / DT)):
        p, v = motion.step(p, v, v_ref, wind, DT)
    return p, v


@given(YAW)
def test_velocities_are_those_of_the_heading(yaw):
    motion, p, v = hovering((0.0, 0.0, 40.0, yaw))
    p, v = flown(motion, p, v, (2.0, 0.0, 0.0, 0.0), 2.0)
    assert v[0] == pytest.approx(2.0, abs=0.3)
    assert v[1] == pytest.approx(0.0, abs=1e-6)
    assert math.atan2(p[1], p[0]) == pytest.approx(yaw, abs=1e-6)
    assert p[3] == pytest.approx(yaw, abs=1e-6)


def test_the_yaw_rate_told_is_the_rate_of_the_yaw_told_leaning_or_not():
    motion, p, v = hovering()
    for step in range(2000):
        v_ref = (5.0 * math.sin(0.01 * step), 5.0 * math.cos(0.017 * step), 0.5, 0.8)
        before, rate = p[3], v[3]
        p, v = motion.step(p, v, v_ref, ZERO3, DT)
        assert wrap(p[3] - before) == pytest.approx(0.5 * (rate + v[3]) * DT, abs=2e-5)
        assert -math.pi <= p[3] <= math.pi


def test_where_the_world_has_put_it_it_is_and_as_slow_as_the_world_has_made_it():
    motion, p, v = hovering()
    p, v = flown(motion, p, v, (3.0, 0.0, 0.0, 0.0), 2.0)
    lean = motion.attitude.pitch
    moved, stopped = (p[0] - 0.5, p[1] + 0.25, p[2], p[3]), (0.0, v[1], v[2], v[3])
    after, speed = motion.step(moved, stopped, (3.0, 0.0, 0.0, 0.0), ZERO3, DT)
    assert after[:3] == pytest.approx(moved[:3], abs=0.01)
    assert speed[0] == pytest.approx(0.0, abs=0.1)
    assert motion.attitude.pitch == pytest.approx(lean, abs=0.02)


@given(YAW, YAW)
def test_turned_by_hand_it_keeps_its_lean_and_its_velocities(first, second):
    motion, p, v = hovering((0.0, 0.0, 40.0, first))
    p, v = flown(motion, p, v, (2.0, 1.0, 0.0, 0.0), 0.5)
    other, q, u = hovering((0.0, 0.0, 40.0, first))
    q, u = flown(other, q, u, (2.0, 1.0, 0.0, 0.0), 0.5)
    straight, there = motion.step(p, v, None, ZERO3, DT)
    turned, here = other.step((*q[:3], second), u, None, ZERO3, DT)
    assert here == pytest.approx(there, abs=1e-9)
    assert wrap(turned[3] - straight[3] - second + p[3]) == pytest.approx(0.0, abs=1e-9)
    assert (other.attitude.roll, other.attitude.pitch) == pytest.approx(
        (motion.attitude.roll, motion.attitude.pitch), abs=1e-9
    )


@given(YAW, st.floats(-2, 2))
def test_spun_by_hand_it_turns_that_much_faster_and_tilts_no_faster(yaw, more):
    motion, p, v = hovering((0.0, 0.0, 40.0, yaw))
    p, v = flown(motion, p, v, (4.0, 2.0, 0.0, 0.3), 0.5)
    roll, pitch = motion.attitude.roll, motion.attitude.pitch
    still, *_ = hovering((0.0, 0.0, 40.0, yaw))
    still.place(motion.state)
    _, plain = still.step(p, v, None, ZERO3, 1e-6)
    _, spun = motion.step(p, (*v[:3], v[3] + more), None, ZERO3, 1e-6)
    assert spun[3] == pytest.approx(plain[3] + more, abs=1e-4)
    assert (motion.attitude.roll, motion.attitude.pitch) == pytest.approx((roll, pitch), abs=1e-4)
    down = math.cos(pitch) * more
    extra = [a - b for a, b in zip(motion.state[10:13], still.state[10:13], strict=True)]
    assert extra == pytest.approx(
        (-math.sin(pitch) * more, math.sin(roll) * down, math.cos(roll) * down), abs=1e-3
    )


def test_stopped_in_the_air_the_rotors_run_down_and_it_falls():
    motion, p, v = hovering()
    p, v = flown(motion, p, v, (0.0, 0.0, 0.0, 0.0), 0.5)
    before = motion.state[13]
    p, v = motion.step(p, v, None, ZERO3, DT)
    assert motion.state[13] == pytest.approx(before * math.exp(-DT / 0.025))
    p, v = flown(motion, p, v, None, 1.0)
    assert v[2] == pytest.approx(-GRAVITY, rel=0.1)
    assert max(motion.state[13:]) < 1e-9
    assert math.hypot(*motion.attitude.specific_force()) < 0.15 * GRAVITY


def test_at_rest_it_stands_level_with_still_rotors_where_it_was_headed():
    motion, p, v = hovering()
    p, v = flown(motion, p, v, (2.0, 1.0, 0.0, 0.5), 1.0)
    motion.rest()
    attitude = motion.attitude
    assert (attitude.roll, attitude.pitch, attitude.roll_rate, attitude.pitch_rate) == (0.0, 0.0, 0.0, 0.0)
    assert attitude.specific_force() == (0.0, 0.0, GRAVITY)
    assert motion.state[13:] == ZERO4
    after, _ = motion.step(p, ZERO4, ZERO4, ZERO3, DT)
    assert after[3] == pytest.approx(p[3])


def test_hovering_an_accelerometer_feels_the_weight_and_falling_nothing():
    motion, p, v = hovering()
    assert motion.attitude.specific_force() == pytest.approx((0.0, 0.0, GRAVITY), abs=1e-9)
    p, v = flown(motion, p, v, (3.0, 0.0, 0.0, 0.0), 0.2)
    forward, left, up = motion.attitude.specific_force()
    # Rotors push along up alone: leaning forward is not felt but as the drag.
    assert abs(forward) < 0.1
    assert abs(left) < 0.1
    assert up > GRAVITY


def test_what_is_felt_is_the_acceleration_that_is_flown():
    motion, p, v = hovering()
    wind = (2.0, -1.0, 0.5)
    p, v = flown(motion, p, v, (3.0, 1.0, 0.5, 0.6), 0.5, wind)
    before = motion.state[3:6]
    felt = motion.attitude.specific_force()
    c, s = math.cos(p[3]), math.sin(p[3])
    onto = motion.attitude.onto_axes
    p, v = motion.step(p, v, (3.0, 1.0, 0.5, 0.6), wind, DT)
    ax, ay, az = ((b - a) / DT for a, b in zip(before, motion.state[3:6], strict=True))
    flown_by = onto((c * ax + s * ay, c * ay - s * ax, az + GRAVITY))
    assert felt == pytest.approx(flown_by, abs=0.15)


@given(YAW)
def test_positive_roll_lowers_the_right_and_positive_pitch_the_nose(yaw):
    motion, p, v = hovering((0.0, 0.0, 40.0, yaw))
    flown(motion, p, v, (4.0, 0.0, 0.0, 0.0), 0.3)
    assert motion.attitude.pitch > 0.1
    assert motion.attitude.roll == pytest.approx(0.0, abs=1e-6)
    motion, p, v = hovering((0.0, 0.0, 40.0, yaw))
    flown(motion, p, v, (0.0, -4.0, 0.0, 0.0), 0.3)
    assert motion.attitude.roll > 0.1
    assert motion.attitude.pitch == pytest.approx(0.0, abs=1e-6)


def test_up_on_the_leaning_bodys_axes_is_what_its_roll_and_pitch_say():
    motion, p, v = hovering()
    flown(motion, p, v, (4.0, -3.0, 0.0, 0.5), 0.4)
    roll, pitch = motion.attitude.roll, motion.attitude.pitch
    assert motion.attitude.onto_axes((0.0, 0.0, 1.0)) == pytest.approx(
        (-math.sin(pitch), math.sin(roll) * math.cos(pitch), math.cos(roll) * math.cos(pitch))
    )
    assert motion.attitude.onto_axes((1.0, 0.0, 0.0))[0] == pytest.approx(math.cos(pitch))


def test_the_reference_it_wants_is_the_velocity_wanted():
    motion, *_ = hovering()
    assert motion.reference(ZERO4, (1.0, 2.0, 3.0, 4.0), (9.0, 9.0, 9.0, 9.0)) == (1.0, 2.0, 3.0, 4.0)


def test_another_step_is_as_good():
    ends = []
    for dt in (0.002, 0.004, 0.008):
        motion, p, v = hovering()
        for _ in range(round(4.0 / dt)):
            p, v = motion.step(p, v, (2.0, 1.0, 0.3, 0.4), (1.0, 0.0, 0.0), dt)
        ends.append(p)
    assert ends[0] == pytest.approx(ends[1], abs=0.02)
    assert ends[2] == pytest.approx(ends[1], abs=0.04)
