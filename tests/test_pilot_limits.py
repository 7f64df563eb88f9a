from cmath import rect
from itertools import pairwise
from math import hypot, inf, nan

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from drivers.vectors import slewed
from groundstation.config import Limits
from groundstation.pilot.limits import Bounds, Motion, SetpointLimiter, SetpointMotion, approach

ROUND = 1 + 1e-9
bounds = st.builds(Bounds, st.floats(0.1, 10), st.floats(0.1, 20), st.floats(1, 200))
plane = st.complex_numbers(max_magnitude=30, allow_nan=False, allow_infinity=False)
targets = st.lists(st.tuples(plane, st.integers(1, 60)), min_size=1, max_size=12)
steps = st.sampled_from([0.00025, 0.001, 0.004, 0.02])


def flown(targets: list, limits: Bounds, dt: float) -> list[Motion]:
    motions = [Motion()]
    for target, ticks in targets:
        for _ in range(ticks):
            motions.append(approach(motions[-1], target, limits, dt))
    return motions


@given(targets, bounds, steps)
@settings(deadline=None)
def test_no_speed_acceleration_or_jerk_beyond_the_limits_whatever_is_commanded(
    targets: list, limits: Bounds, dt: float
) -> None:
    velocities = [motion.velocity for motion in flown(targets, limits, dt)]
    accelerations = [(b - a) / dt for a, b in pairwise(velocities)]
    jerks = [(b - a) / dt for a, b in pairwise(accelerations)]
    noise = 1e-12 / dt**2
    assert max(map(abs, velocities)) <= limits.speed * ROUND
    assert max(map(abs, accelerations)) <= limits.acceleration * ROUND + noise
    assert max(map(abs, jerks), default=0.0) <= limits.jerk * ROUND + noise


@given(st.floats(0, 2), st.floats(0, 7), st.floats(0, 2), plane, bounds, st.floats(0.001, 0.02))
@settings(deadline=None, max_examples=400)
def test_at_the_edge_of_the_speeds_no_push_leads_out(
    inside: float, heading: float, build: float, target: complex, limits: Bounds, dt: float
) -> None:
    # Just inside the fastest, by as much as braking needs and a little; lengths in what one tick of jerk does.
    a = min(build * limits.jerk * dt, limits.acceleration) * rect(1.0, heading)
    v = max(limits.speed - (inside + build**2) * limits.jerk * dt**2, 0.0)
    assume(abs(v + a * abs(a) / (2 * limits.jerk)) <= limits.speed)
    after = approach(Motion(v, a), target, limits, dt)
    assert abs(after.velocity) <= limits.speed * ROUND
    reach = after.velocity + after.acceleration * abs(after.acceleration) / (2 * limits.jerk)
    assert abs(reach) <= limits.speed * ROUND


def test_a_sharp_turn_at_the_fastest_does_not_lead_out_of_it_for_a_tick() -> None:
    # Here the velocity would leave the circle and braking from there would lead back into it.
    after = approach(Motion(2.9991349, 0.184834 + 0.014052j), 0.8274 - 3.2415j, Bounds(3.0, 3.0, 20.0), 0.02)
    assert abs(after.velocity) <= 3.0 * ROUND


@given(targets, plane, bounds, steps)
@settings(deadline=None)
def test_a_held_command_is_reached_and_stays_reached(
    targets: list, last: complex, limits: Bounds, dt: float
) -> None:
    motion = flown(targets, limits, dt)[-1]
    goal = last if abs(last) <= limits.speed else last * (limits.speed / abs(last))
    # The way there in a straight line, twice over, and building up and taking back the acceleration.
    enough = 4 * limits.speed / limits.acceleration + 8 * (limits.acceleration + limits.speed) / limits.jerk
    for _ in range(int(enough / dt) + 200):
        motion = approach(motion, last, limits, dt)
    assert motion.velocity == pytest.approx(goal, abs=1e-6)
    assert abs(motion.acceleration) < 1e-3
    assert approach(motion, last, limits, dt).velocity == pytest.approx(goal, abs=1e-6)


@given(st.floats(-5, 5), bounds, steps)
@settings(deadline=None)
def test_a_step_from_rest_is_reached_without_overshoot_and_without_turning_back(
    target: float, limits: Bounds, dt: float
) -> None:
    goal = min(max(target, -limits.speed), limits.speed)
    velocities = [motion.velocity.real for motion in flown([(target, 2000)], limits, dt)]
    progress = [velocity if goal >= 0 else -velocity for velocity in velocities]
    assert max(progress) <= abs(goal) + 1e-9
    assert all(after >= before - 1e-9 for before, after in pairwise(progress))


def test_a_step_takes_the_time_that_acceleration_and_jerk_allow() -> None:
    # From 0 to 3 m/s with 3 m/s² and 20 m/s³: 3/3 + 3/20 = 1.15 s.
    motions = flown([(3.0, 1300)], Bounds(3.0, 3.0, 20.0), 0.001)
    assert abs(motions[1140].velocity - 3.0) > 1e-4
    assert motions[1155].velocity == pytest.approx(3.0, abs=1e-4)


def test_the_plane_is_limited_by_length_and_keeps_its_direction() -> None:
    limiter, motion, velocity = SetpointLimiter(Limits(horizontal_speed=3.0)), SetpointMotion(), None
    for _ in range(3000):
        motion, velocity = limiter.step(motion, (40.0, 30.0, 9.0, -9.0), 0.001)
        if hypot(*velocity[:2]) > 1e-9:
            assert velocity[0] / velocity[1] == pytest.approx(4 / 3)
    assert velocity == pytest.approx((2.4, 1.8, 1.5, -1.0))


@pytest.mark.parametrize("bad", [nan, inf, -inf])
@pytest.mark.parametrize("axis", range(4))
def test_what_is_not_finite_is_refused(bad: float, axis: int) -> None:
    v_ref = [0.0, 0.0, 0.0, 0.0]
    v_ref[axis] = bad
    with pytest.raises(ValueError, match="not finite"):
        SetpointLimiter(Limits()).step(SetpointMotion(), tuple(v_ref), 0.001)
    with pytest.raises(ValueError, match="not finite"):
        slewed((0.0, 0.0, 0.0), tuple(v_ref[1:]) if axis else (bad, 0.0, 0.0), 1.0)


forces = st.tuples(*[st.floats(-20, 20)] * 3)


@given(forces, forces, st.floats(0.001, 5))
def test_a_force_goes_straight_to_its_target_by_no_more_than_the_step(
    force: tuple, target: tuple, step: float
) -> None:
    before = hypot(*(b - a for a, b in zip(force, target, strict=True)))
    moved = slewed(force, target, step)
    left = hypot(*(b - a for a, b in zip(moved, target, strict=True)))
    assert hypot(*(b - a for a, b in zip(force, moved, strict=True))) <= step * ROUND
    assert left == pytest.approx(max(0.0, before - step), abs=1e-9)
