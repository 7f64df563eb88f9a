"""The Falcon's geometry: against its constraint, against itself, and against libnifalcon's formula."""

from __future__ import annotations

import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.falcon import kinematics
from drivers.falcon.kinematics import CENTRE, Pose, angles, combine, locate, slopes, torques
from drivers.falcon.units import ANGLE_AT_ZERO, COUNT, force_counts, from_handle, leg_angle, to_handle

RADIUS = 0.05


def grid(step=0.01):
    """Places all over the workspace, its edge included."""
    number = round(RADIUS / step)
    for i in range(-number, number + 1):
        for j in range(-number, number + 1):
            for k in range(-number, number + 1):
                if math.hypot(i, j, k) <= number:
                    yield CENTRE[0] + i * step, CENTRE[1] + j * step, CENTRE[2] + k * step


def known(pose: Pose | None) -> Pose:
    assert pose is not None
    return pose


def turned(a, b):
    """The angle between two vectors, degrees; exact for small ones, unlike the arc cosine."""
    unit_a, unit_b = ([x / math.hypot(*v) for x in v] for v in (a, b))
    return math.degrees(2.0 * math.asin(min(1.0, math.dist(unit_a, unit_b) / 2.0)))


places = st.builds(
    lambda x, y, z: (CENTRE[0] + x, CENTRE[1] + y, CENTRE[2] + z),
    *(st.floats(-RADIUS / math.sqrt(3), RADIUS / math.sqrt(3)),) * 3,
)
forces = st.tuples(*(st.floats(-100, 100),) * 3).filter(lambda force: math.hypot(*force) > 0.1)


def half_tangent(phi, place):
    """Leg angle by Stamper's quadratic in tan(θ/2), as libnifalcon writes it: an independent solution."""
    a, b, c, d, e, f, r, s = 0.060, 0.1025, 0.01443, 0.01125, 0.01125, -0.025, 0.040, -0.02309
    x, y, z = place
    u = -r + math.cos(phi) * x + math.sin(phi) * y
    v = -(s - math.cos(phi) * y + math.sin(phi) * x)
    sin3 = math.sin(math.acos((v + f) / b))
    common = z * z + u * u + 2 * c * u + a * a + c * c - (b * sin3 + d + e) ** 2
    l0, l1, l2 = common - 2 * a * u - 2 * a * c, -4 * a * z, common + 2 * a * u + 2 * a * c
    return 2 * math.atan(-(math.sqrt(l1 * l1 - 4 * l2 * l0) + l1) / (2 * l2))


def test_the_inverse_is_stampers():
    for place in grid():
        ours = angles(place)
        for theta, degrees in zip(ours, (105, -15, -135), strict=True):
            assert theta == pytest.approx(half_tangent(math.radians(degrees), place), abs=1e-9)


def test_forward_of_inverse_is_within_a_micrometre_from_a_cold_start():
    count = 0
    for place in grid(0.005):
        assert math.dist(known(locate(angles(place))).position, place) <= 1e-9
        count += 1
    assert count > 4_000


@given(places, places)
def test_forward_of_inverse_from_any_start_is_the_place_or_refused(place, start):
    """A start 10 cm away may fail, never mislead; the centre always works, above."""
    pose = locate(angles(place), start)
    assert pose is None or math.dist(pose.position, place) <= 1e-9


def test_a_handle_in_motion_is_followed_from_sample_to_sample():
    at = CENTRE
    for tick in range(5_000):
        t = tick * 1e-3
        place = (0.04 * math.sin(30 * t), 0.03 * math.cos(29 * t), CENTRE[2] + 0.03 * math.sin(31 * t))
        if tick:
            at = known(locate(angles(place), at)).position
            assert math.dist(at, place) <= 1e-9
        else:
            at = place


@given(places)
def test_slopes_are_the_inverse_differentiated(place):
    step = 1e-5
    rows = slopes(place)
    for axis in range(3):
        ahead, behind = list(place), list(place)
        ahead[axis] += step
        behind[axis] -= step
        for row, late, early in zip(rows, angles(tuple(ahead)), angles(tuple(behind)), strict=True):
            assert abs(row[axis] - (late - early) / (2 * step)) <= 1e-4 * math.hypot(*row)


@given(places)
def test_the_poses_columns_are_the_inverse_of_the_slopes(place):
    columns = known(locate(angles(place), place)).columns
    for i, row in enumerate(slopes(place)):
        for k, column in enumerate(columns):
            product = sum(a * b for a, b in zip(row, column, strict=True))
            assert product == pytest.approx(1.0 if i == k else 0.0, abs=1e-6)


@given(places, forces)
def test_torques_do_the_work_of_the_force(place, force):
    """Virtual work: what the legs' torques do on any motion is what the force does."""
    pose = known(locate(angles(place)))
    rates = (0.3, -0.2, 0.5)
    velocity = combine(pose.columns, rates)
    of_legs = sum(a * b for a, b in zip(torques(pose, force), rates, strict=True))
    of_force = sum(a * b for a, b in zip(force, velocity, strict=True))
    assert of_legs == pytest.approx(of_force, abs=1e-12)


@given(places, forces)
def test_saturation_keeps_the_direction(place, force):
    counts = force_counts(known(locate(angles(place))), force)
    assert max(map(abs, counts)) <= 4095
    if max(map(abs, counts)) == 4095:
        assert turned(force, combine(slopes(place), tuple(-c / 1e4 for c in counts))) <= 0.1


def test_small_forces_come_out_as_they_are():
    for place in grid(0.02):
        force = (1.5, -1.0, 2.0)
        counts = force_counts(known(locate(angles(place))), force)
        felt = combine(slopes(place), tuple(-c / 1e4 for c in counts))
        assert math.dist(felt, force) < 0.01


def test_the_published_force_vector():
    """F = [0, 0, −100] → 4095, 3906, 4034.

    Where the handle was is not published. On the axis the three are equal; 1.2 mm off it, as a grip at rest
    is, ∂position/∂θ and this scaling give exactly these. With ∂θ/∂position in its place nothing near does.
    """
    pose = known(locate(angles((-0.00105026, 0.00065488, 0.110))))
    assert force_counts(pose, (0.0, 0.0, -100.0)) == (4095, 3906, 4034)
    assert force_counts(known(locate(angles((0.0, 0.0, 0.110)))), (0.0, 0.0, -100.0)) == (4095, 4095, 4095)


def test_pushing_the_grip_down_needs_legs_that_press_it_down():
    """Sign, apart from any formula: motors that follow the counts' sign open the angle and pull the grip in."""
    pose = known(locate(angles(CENTRE)))
    counts = force_counts(pose, (0.0, 0.0, -5.0))
    further = tuple(theta - 1e-4 * count for theta, count in zip(angles(CENTRE), counts, strict=True))
    assert known(locate(further)).position[2] < CENTRE[2]


def test_an_encoder_count_is_as_documented():
    assert math.degrees(leg_angle(0)) == pytest.approx(35.0)
    assert math.degrees(leg_angle(1000)) == pytest.approx(35.0 + 36.4347)
    assert math.radians(360 / 1280 * 0.01425 / 0.110) == pytest.approx(COUNT, rel=1e-5)
    assert math.radians(35.0) == ANGLE_AT_ZERO
    # About 0.06 mm a tick in z near the centre, all legs together: devices' users quote it.
    near = known(locate(tuple(theta + COUNT for theta in angles(CENTRE))))
    assert 0.03e-3 < near.position[2] - CENTRE[2] < 0.08e-3


def test_legs_that_cannot_stand_so_have_no_place():
    assert locate((math.radians(90), math.radians(-60), math.radians(90))) is None
    chance = random.Random(2)
    for _ in range(3_000):
        legs = tuple(leg_angle(chance.randint(-32768, 32767)) for _ in range(3))
        pose = locate(legs)
        if pose is not None:
            assert math.dist(pose.position, CENTRE) <= kinematics.REACH
            assert all(
                math.cos(a - b) == pytest.approx(1.0, abs=1e-9)
                for a, b in zip(angles(pose.position), legs, strict=True)
            )


def test_out_of_reach_is_told():
    with pytest.raises(ValueError, match="math domain"):
        angles((0.0, 0.0, 0.4))


def test_the_handles_axes():
    """Toward the operator is backward, the operator's right is −y, up is z."""
    assert to_handle((0.0, 0.0, 0.01)) == (-0.01, 0.0, 0.0)
    assert to_handle((0.01, 0.0, 0.0)) == (0.0, -0.01, 0.0)
    assert to_handle((0.0, 0.01, 0.0)) == (0.0, 0.0, 0.01)
    assert from_handle(to_handle((1.0, 2.0, 3.0))) == (1.0, 2.0, 3.0)
