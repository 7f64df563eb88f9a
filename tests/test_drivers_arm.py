"""The arm: equation, passivity, stability."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.arm import Arm, ArmState, stop
from drivers.device import ZERO3

WORKSPACE = 0.1
FORCE = 10.0


def vectors(limit):
    return st.tuples(*(st.floats(-limit / math.sqrt(3), limit / math.sqrt(3)),) * 3)


steps = st.sampled_from([1e-4, 1e-3, 0.01, 0.2, 3.0])
arms = st.builds(Arm, mass=st.floats(0.05, 5.0), stiffness=st.floats(10.0, 2000.0))
states = st.builds(
    ArmState,
    position=vectors(WORKSPACE),
    velocity=vectors(2.0),
    yaw=st.floats(-math.pi, math.pi),
    yaw_rate=st.floats(-5.0, 5.0),
)


def integrate(arm, state, intention, yaw, force, duration, dt=1e-6):
    """Semi-implicit Euler on the documented equation, one axis: an independent solution."""
    b = 2.0 * math.sqrt(arm.stiffness * arm.mass)
    x, v = state.position[0], state.velocity[0]
    for _ in range(round(duration / dt)):
        v += (force[0] - b * v - arm.stiffness * (x - intention[0])) / arm.mass * dt
        x += v * dt
    return x, v


@pytest.mark.parametrize("force", [0.0, -6.0])
def test_it_solves_the_documented_equation(force):
    arm, start = Arm(), ArmState((0.02, 0.0, 0.0), (-0.3, 0.0, 0.0))
    args = ((0.06, 0.0, 0.0), 0.0, (force, 0.0, 0.0))
    x, v = integrate(arm, start, *args, duration=0.15)
    moved = arm.step(start, 0.15, *args)
    assert moved.position[0] == pytest.approx(x, abs=1e-6)
    assert moved.velocity[0] == pytest.approx(v, abs=1e-5)


@given(arms, states, vectors(WORKSPACE), st.floats(-3, 3), vectors(FORCE), st.floats(0, 0.5))
def test_a_hundred_small_steps_are_one_large(arm, state, intention, yaw, force, duration):
    many = state
    for _ in range(100):
        many = arm.step(many, duration / 100, intention, yaw, force)
    once = arm.step(state, duration, intention, yaw, force)
    assert many.position == pytest.approx(once.position, abs=1e-9)
    assert many.velocity == pytest.approx(once.velocity, abs=1e-8)
    assert many.yaw == pytest.approx(once.yaw, abs=1e-8)


@given(arms, states, steps, vectors(WORKSPACE), vectors(FORCE))
def test_it_is_passive(arm, state, dt, intention, force):
    """With the intention held, the stored energy never grows by more than the work done by the force."""
    moved = arm.step(state, dt, intention, 0.0, force)
    work = sum(f * (b - a) for f, a, b in zip(force, state.position, moved.position, strict=True))
    before, after = arm.energy(state, intention), arm.energy(moved, intention)
    assert after <= before + work + 1e-9 * (1.0 + before + abs(work))


@given(arms, states, steps, vectors(WORKSPACE))
def test_the_stop_takes_energy_and_gives_none(arm, state, dt, intention):
    moved = arm.step(state, dt, intention, 0.0, ZERO3)
    stopped = stop(moved, WORKSPACE)
    assert math.hypot(*stopped.position) <= WORKSPACE * (1 + 1e-12)
    assert arm.energy(stopped, intention) <= arm.energy(moved, intention) * (1 + 1e-9) + 1e-15
    again = stop(stopped, WORKSPACE)
    assert again.position == pytest.approx(stopped.position, abs=1e-12)


@given(arms, st.lists(st.tuples(steps, vectors(WORKSPACE), st.floats(-3, 3), vectors(FORCE)), max_size=60))
def test_any_intentions_and_forces_within_limits_leave_it_bounded_and_it_settles(arm, sequence):
    """Nothing grows beyond what a critically damped arm reaches from rest; left alone, it comes to rest."""
    omega = math.sqrt(arm.stiffness / arm.mass)
    reach = WORKSPACE + FORCE / arm.stiffness
    state = ArmState()
    for dt, intention, yaw, force in sequence:
        state = arm.step(state, dt, intention, yaw, force)
        # The impulse response ω² t e^(−ωt) is positive with area 1, its derivative has area 2 ω / e.
        assert math.hypot(*state.position) <= reach * (1 + 1e-9)
        assert math.hypot(*state.velocity) <= 2.0 * omega * reach / math.e * (1 + 1e-9)
        assert abs(state.yaw) <= 3.0 * (1 + 1e-9)
    for _ in range(40):
        state = arm.step(state, 1.0 / omega, (0.03, -0.02, 0.05), 0.4, ZERO3)
    assert state.position == pytest.approx((0.03, -0.02, 0.05), abs=1e-9)
    assert state.velocity == pytest.approx(ZERO3, abs=1e-9)
    assert state.yaw == pytest.approx(0.4, abs=1e-9)


def test_the_hand_follows_as_documented_and_never_overshoots():
    arm, state, reached = Arm(), ArmState(), {}
    for tick in range(1, 1001):
        state = arm.step(state, 1e-3, (0.05, 0.0, 0.0), 0.0, ZERO3)
        assert state.position[0] <= 0.05
        for share in (0.63, 0.80):
            if state.position[0] >= 0.05 * share:
                reached.setdefault(share, tick * 1e-3)
    assert reached[0.63] == pytest.approx(0.14, abs=0.005)
    assert reached[0.80] == pytest.approx(0.19, abs=0.005)


def test_it_yields_to_a_steady_force_by_its_stiffness():
    arm, state = Arm(), ArmState()
    for _ in range(2000):
        state = arm.step(state, 1e-3, (0.02, 0.0, 0.0), 0.0, (-2.7, 0.0, 1.35))
    assert state.position == pytest.approx((0.0, 0.0, 0.01), abs=1e-6)


def test_the_stop_keeps_what_slides_along_it():
    stopped = stop(ArmState((0.2, 0.0, 0.0), (1.0, 0.5, -0.25), 0.3, 0.1), WORKSPACE)
    assert stopped == ArmState((0.1, 0.0, 0.0), (0.0, 0.5, -0.25), 0.3, 0.1)
    inward = ArmState((0.2, 0.0, 0.0), (-1.0, 0.0, 0.0))
    assert stop(inward, WORKSPACE).velocity == (-1.0, 0.0, 0.0)
