"""The kinematic and the dynamic model, falling, and the lean that goes with them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import astuple

from sim.airframe import MODELS, load_airframe
from sim.kinematics import ZERO3, ZERO4
from sim.models.dynamic import Chi, Dynamic, rate
from sim.models.falling import Falling
from sim.models.kinematic import Kinematic
from sim.models.lean import Lean
from sim.models.motion import GRAVITY

M100 = load_airframe("matrice_100")
DYNAMIC = Dynamic(M100.chi, M100.air_drag, Lean(0.6, 0.12, 0.3))
CHI = astuple(M100.chi)
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
    assert rate((1.0, 2.0, 0.5, 0.3), (1.0, 1.0, 1.0, 1.0), ZERO3, CHI) == pytest.approx(
        (forward, left, up, turn)
    )


def test_turning_left_pushes_a_forward_velocity_right_and_a_left_one_forward():
    assert rate((1.0, 0.0, 0.0, 1.0), ZERO4, ZERO3, CHI)[1] == pytest.approx(-0.3984 / 0.6344)
    straight = rate((0.0, 1.0, 0.0, 0.0), ZERO4, ZERO3, CHI)[0]
    assert rate((0.0, 1.0, 0.0, 1.0), ZERO4, ZERO3, CHI)[0] - straight == pytest.approx(0.8109 / 0.6756)


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
    assert rate(v, reference, ZERO3, CHI) == pytest.approx(acceleration, abs=1e-9)


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


def test_all_models_answer_the_same_calls():
    x500 = load_airframe("x500")
    for model in MODELS.values():
        motion = model(x500)
        p, v = flown(motion, (1.0, 0.0, 0.0, 0.5), 3.0, p=(0.0, 0.0, 50.0, 1.0))
        assert p[3] == pytest.approx(1.0 + 0.5 * 3.0, abs=0.2)
        assert v[0] == pytest.approx(1.0, abs=0.1)
        assert len(motion.reference(v, v, ZERO4)) == 4


def falls(drag, seconds, v=ZERO4, wind=ZERO3, dt=0.004, p=ZERO4):
    falling = Falling(drag)
    for _ in range(round(seconds / dt)):
        p, v = falling.step(p, v, wind, dt)
    return p, v


def fallen(drag, t, v=ZERO3, wind=ZERO3):
    """By hand: position and velocity, world, of ẍ = −D (ẋ − w) − g ẑ from the origin."""
    if drag == 0.0:
        return [b * t for b in v[:2]] + [v[2] * t - 0.5 * GRAVITY * t * t], [*v[:2], v[2] - GRAVITY * t]
    last = [wind[0], wind[1], wind[2] - GRAVITY / drag]
    gone = 1.0 - math.exp(-drag * t)
    where = [a * t + (b - a) * gone / drag for a, b in zip(last, v, strict=True)]
    return where, [a + (b - a) * (1.0 - gone) for a, b in zip(last, v, strict=True)]


@pytest.mark.parametrize("drag", [0.0, 0.01, 0.1, 0.24, 0.5, 3.0])
@pytest.mark.parametrize("dt", [0.001, 0.004, 0.1])
def test_without_motors_it_falls_as_the_closed_form_says_with_and_without_drag(drag, dt):
    p, v = falls(drag, 4.0, v=(3.0, -1.0, 2.0, 0.0), wind=(2.0, 5.0, -0.5), dt=dt)
    where, speed = fallen(drag, 4.0, (3.0, -1.0, 2.0), (2.0, 5.0, -0.5))
    assert p[:3] == pytest.approx(where, abs=1e-6)
    assert v[:3] == pytest.approx(speed, abs=1e-6)


def test_in_the_end_it_falls_at_terminal_speed():
    _, v = falls(0.5, 60.0, wind=(2.0, 0.0, 0.0))
    assert v == pytest.approx((2.0, 0.0, -GRAVITY / 0.5, 0.0), abs=1e-9)


@given(st.floats(-3, 3), st.floats(-6, 6))
def test_a_spinning_body_falls_as_straight_as_one_that_does_not_spin(yaw, spin):
    straight, _ = falls(0.3, 1.0, v=(3.0, 0.0, 0.0, 0.0), wind=(1.0, 2.0, 0.0), p=(0.0, 0.0, 9.0, yaw))
    spinning, _ = falls(0.3, 1.0, v=(3.0, 0.0, 0.0, spin), wind=(1.0, 2.0, 0.0), p=(0.0, 0.0, 9.0, yaw))
    assert spinning[:3] == pytest.approx(straight[:3], abs=1e-9)
    assert spinning[3] == pytest.approx(yaw + spin)


def recorded(model, seconds=60.0, dt=0.004):
    """A well excited flight: references and velocities, one row a step."""
    p, v, references, velocities = ZERO4, ZERO4, [], []
    for step in range(round(seconds / dt)):
        t = step * dt
        v_ref = tuple(
            size
            * sum(math.sin(f * (1.0 + 0.07 * axis) * t + axis * f) for f in (0.3, 0.7, 1.6, 2.9, 5.1))
            / 2.0
            for axis, size in enumerate((1.2, 1.0, 0.8, 0.7))
        )
        references.append(v_ref)
        velocities.append(v)
        p, v = model.step(p, v, v_ref, ZERO3, dt)
    return np.array(references), np.array(velocities)


def identified(references, velocities, dt=0.004):
    """χ by least squares, axis by axis, the accelerations from the velocities as from a flight's recording."""
    v, a = velocities[1:-1], (velocities[2:] - velocities[:-2]) / (2.0 * dt)
    # A reference holds from its sample to the next: at the sample it is the mean of two.
    r = 0.5 * (references[1:-1] + references[:-2])
    regressors = (
        (a[:, 0], v[:, 0], v[:, 3] * v[:, 1]),
        (a[:, 1], v[:, 1], v[:, 3] * v[:, 0]),
        (a[:, 2], v[:, 2]),
        (a[:, 3], v[:, 3]),
    )
    forward, left, up, turn = (
        np.linalg.lstsq(np.stack(columns, axis=1), r[:, axis], rcond=None)[0]
        for axis, columns in enumerate(regressors)
    )
    return (forward[0], left[0], up[0], turn[0], forward[1], forward[2], left[2], left[1], up[1], turn[1])


def test_the_dynamic_model_reproduces_its_own_identification():
    references, velocities = recorded(DYNAMIC)
    chi = identified(references, velocities)
    assert chi == pytest.approx(CHI, rel=1e-3)
    again = Dynamic(Chi(*map(float, chi)), 0.0, Lean(0.6, 0.12, 0.3))
    p, v, predicted = ZERO4, ZERO4, []
    for v_ref in references:
        predicted.append(v)
        p, v = again.step(p, v, tuple(v_ref), ZERO3, 0.004)
    error = ((np.array(predicted) - velocities) ** 2).sum(axis=0)
    spread = ((velocities - velocities.mean(axis=0)) ** 2).sum(axis=0)
    assert (1.0 - error / spread >= 0.9999).all()
    assert (velocities.std(axis=0) > 0.3).all()


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
