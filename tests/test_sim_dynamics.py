"""The two models of motion, falling, and the lean that goes with them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.airframe import MODELS, load_airframe
from sim.kinematics import ZERO3, ZERO4
from sim.models.dynamic import Dynamic
from sim.models.falling import Falling
from sim.models.kinematic import Kinematic
from sim.models.lean import Lean
from sim.models.motion import GRAVITY

M100 = load_airframe("matrice_100")
DYNAMIC = Dynamic(M100.chi, M100.air_drag, Lean(0.6, 0.12, 0.3))
VELOCITIES = st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3), st.floats(-1.5, 1.5))


def flown(model, v_ref, seconds, dt=0.004, p=ZERO4, v=ZERO4, wind=ZERO3):
    for _ in range(round(seconds / dt)):
        p, v = model.step(p, v, v_ref, wind, dt)
    return p, v


def test_the_rate_is_what_hand_calculation_gives():
    """By hand, with the Matrice 100's numbers: v = (1, 2, 0.5, 0.3), v_ref = (1, 1, 1, 1)."""
    forward = (1 - 0.5941 * 1 - 0.3 * -0.8109 * 2) / 0.6756
    left = (1 - 0.3 * 0.3984 * 1 - 0.7040 * 2) / 0.6344
    up = (1 - 0.9365 * 0.5) / 0.4080
    turn = (1 - 0.9752 * 0.3) / 0.2953
    assert (forward, left, up, turn) == pytest.approx((1.320959, -0.831526, 1.303309, 2.395665), abs=1e-6)
    rate = DYNAMIC.rate((1.0, 2.0, 0.5, 0.3), (1.0, 1.0, 1.0, 1.0), ZERO3)
    assert rate == pytest.approx((forward, left, up, turn))


def test_turning_left_pushes_a_forward_velocity_right_and_a_left_one_forward():
    assert DYNAMIC.rate((1.0, 0.0, 0.0, 1.0), ZERO4, ZERO3)[1] == pytest.approx(-0.3984 / 0.6344)
    straight = DYNAMIC.rate((0.0, 1.0, 0.0, 0.0), ZERO4, ZERO3)[0]
    assert DYNAMIC.rate((0.0, 1.0, 0.0, 1.0), ZERO4, ZERO3)[0] - straight == pytest.approx(0.8109 / 0.6756)


def test_at_rest_the_gain_is_the_inverse_of_the_damping():
    _, v = flown(DYNAMIC, (1.0, 0.0, 0.0, 0.0), 20)
    assert v == pytest.approx((1 / 0.5941, 0.0, 0.0, 0.0), abs=1e-6)
    _, v = flown(DYNAMIC, (0.0, 1.0, 0.5, 0.0), 20)
    assert v == pytest.approx((0.0, 1 / 0.7040, 0.5 / 0.9365, 0.0), abs=1e-6)


def test_yaw_rate_and_climb_follow_their_exponential():
    _, v = flown(DYNAMIC, (0.0, 0.0, 0.6, 0.8), 0.4)
    assert v[3] == pytest.approx(0.8 / 0.9752 * (1 - math.exp(-0.9752 / 0.2953 * 0.4)), rel=1e-8)
    assert v[2] == pytest.approx(0.6 / 0.9365 * (1 - math.exp(-0.9365 / 0.4080 * 0.4)), rel=1e-8)


def test_the_step_is_small_enough():
    """The same turning flight at 250 Hz and at 4 kHz ends within a tenth of a millimetre."""
    coarse, _ = flown(DYNAMIC, (1.5, -0.7, 0.4, 0.6), 6.0)
    fine, _ = flown(DYNAMIC, (1.5, -0.7, 0.4, 0.6), 6.0, dt=0.00025)
    assert coarse == pytest.approx(fine, abs=1e-4)


@given(VELOCITIES, VELOCITIES)
def test_the_reference_is_the_inverse_of_the_model(v, acceleration):
    reference = DYNAMIC.reference(v, ZERO4, acceleration)
    assert DYNAMIC.rate(v, reference, ZERO3) == pytest.approx(acceleration, abs=1e-9)


@given(st.floats(-math.pi, math.pi))
def test_wind_drifts_the_vehicle_with_the_air_whatever_its_heading(yaw):
    """With no reference, drag D w = C v / M: the drift is along the wind where the axis is aligned with it."""
    model = Dynamic(load_airframe("x500").chi, 0.3, Lean(0.6, 0.12, 0.3))
    p, _ = flown(model, ZERO4, 10.0, dt=0.02, p=(0.0, 0.0, 0.0, yaw), wind=(1.0, 0.0, 0.0))
    assert p[0] == pytest.approx(0.3 * 0.556 * (10.0 - 0.556), rel=1e-3)
    assert p[1] == pytest.approx(0.0, abs=1e-9)


def test_wind_from_behind_a_vehicle_that_faces_north_is_an_acceleration_forward():
    _, v = DYNAMIC.step((0.0, 0.0, 0.0, math.pi / 2), ZERO4, ZERO4, (0.0, 2.0, 0.5), 1e-4)
    assert v == pytest.approx((0.3 * 2.0 * 1e-4, 0.0, 0.3 * 0.5 * 1e-4, 0.0), rel=1e-3, abs=1e-9)


@given(VELOCITIES, st.integers(1, 200))
def test_the_kinematic_model_is_exact(v_ref, steps):
    straight = (*v_ref[:3], 0.0)
    p, v = flown(
        Kinematic(0.3, Lean(0.6, 0.12, 0.3)),
        straight,
        steps * 0.004,
        p=(1.0, 2.0, 3.0, 0.0),
        wind=(9.0, 9.0, 9.0),
    )
    t = steps * 0.004
    assert v == straight
    assert p == pytest.approx((1 + straight[0] * t, 2 + straight[1] * t, 3 + straight[2] * t, 0.0), abs=1e-9)


def test_both_models_answer_the_same_calls():
    for model in MODELS.values():
        motion = model(M100)
        p, v = motion.step(ZERO4, ZERO4, (1.0, 0.0, 0.0, 0.0), ZERO3, 0.004)
        assert p[0] > 0.0
        assert v[0] > 0.0
        assert len(motion.reference(v, v, ZERO4)) == 4


def fallen(falling, seconds, dt=0.004, v=ZERO4, wind=ZERO3):
    p = ZERO4
    for _ in range(round(seconds / dt)):
        p, v = falling.step(p, v, wind, dt)
    return p, v


def test_a_body_without_motors_falls_to_terminal_speed():
    _, v = fallen(Falling(0.5), 0.1)
    assert v[2] == pytest.approx(-GRAVITY * 0.1, rel=0.03)
    _, v = fallen(Falling(0.5), 30.0, wind=(2.0, 0.0, 0.0))
    assert v[2] == pytest.approx(-GRAVITY / 0.5, rel=1e-3)
    assert v[0] == pytest.approx(2.0, rel=1e-3)


def test_a_spinning_body_falls_straight():
    p, _ = fallen(Falling(0.0), 2.0, v=(3.0, 0.0, 0.0, 2.0), dt=0.0005)
    assert p[:2] == pytest.approx((6.0, 0.0), abs=0.02)


def lean(before, after, air=ZERO3, limit=0.7):
    """Lean for a change of velocity, at a velocity through the `air`."""
    attitude = Lean(limit, 0.01, 0.3)
    wind = (after[0] - air[0], after[1] - air[1], after[2] - air[2])
    attitude.follow(ZERO4, before, after, wind, 1.0)
    return attitude


def test_the_vehicle_leans_into_its_acceleration():
    forward = lean(ZERO4, (2.0, 0.0, 0.0, 0.0))
    assert forward.pitch == pytest.approx(math.atan2(2.0, GRAVITY))
    assert forward.roll == pytest.approx(0.0)
    left = lean(ZERO4, (0.0, 2.0, 0.0, 0.0))
    assert left.roll == pytest.approx(-math.atan2(2.0, GRAVITY))
    assert left.pitch == pytest.approx(0.0)


def test_it_leans_against_drag_and_into_a_turn():
    assert lean((4.0, 0, 0, 0), (4.0, 0, 0, 0), air=(4.0, 0, 0)).pitch == pytest.approx(
        math.atan2(1.2, GRAVITY)
    )
    assert lean((4.0, 0, 0, 0.5), (4.0, 0, 0, 0.5)).roll == pytest.approx(-math.atan2(2.0, GRAVITY))


def test_no_lean_exceeds_the_limit():
    wild = lean(ZERO4, (500.0, 500.0, -500.0, 0.0))
    assert abs(wild.roll) <= 0.7
    assert abs(wild.pitch) <= 0.7


def test_an_accelerometer_at_hover_feels_gravity_upward_and_nothing_sideways_when_leaning_with_it():
    assert lean(ZERO4, ZERO4).specific_force() == pytest.approx((0.0, 0.0, GRAVITY))
    force = lean(ZERO4, (2.0, 1.0, 0.0, 0.0)).specific_force()
    assert force == pytest.approx((0.0, 0.0, math.sqrt(4 + 1 + GRAVITY**2)), abs=1e-9)
