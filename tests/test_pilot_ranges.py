"""From a ring of distances to the points that matter: the right ones, and the vehicle's own echo left out."""

import math
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.messages import RING_SECTORS
from groundstation.pilot.ranges import MOST_POINTS, REACH, Echoes, Seen, bounding, echoes
from sim.environment.rangefinder import ring
from sim.environment.world import World
from sim.scenario import Cylinder, Wall

NAN, INF = math.nan, math.inf
NOTHING = (INF,) * RING_SECTORS
RADIUS = 0.5
HERE = (0.0, 0.0, 2.0, 0.0)


def seen_in(world, pose):
    return Seen(ring(World(world), pose), NAN, NAN)


def mattering(seen, pose=HERE):
    return bounding(echoes(seen, pose, RADIUS), pose[:3])


def test_a_wall_is_its_nearest_point_wherever_the_vehicle_looks():
    wall = [Wall("wall", (3.0, -9.0), (3.0, 9.0), 4.0)]
    for yaw in (0.0, 0.7, math.pi, -2.0):
        pose = (0.0, 1.0, 2.0, yaw)
        (point,) = mattering(seen_in(wall, pose), pose)
        assert point == pytest.approx((2.95, 1.0, 2.0), abs=0.14)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_wall_is_straight_however_coarse_and_noisy_its_echoes_are(noise):
    """Centimetres and sectors of 5°; the points may not jump from one look to the next."""
    wall, random = World([Wall("wall", (1.0, -9.0), (1.0, 9.0), 4.0)]), Random(1)
    for step in range(60):
        pose = (0.0, 0.03 * step, 2.0, 0.02 * step)
        distances = [round(d + random.gauss(0.0, noise), 2) for d in ring(wall, pose)]
        (x, y, _), *more = mattering(Seen(distances, NAN, NAN), pose)
        assert not more
        assert x == pytest.approx(0.95, abs=0.01 + 4.0 * noise)
        assert math.atan2(y - pose[1], x) == pytest.approx(0.0, abs=0.02 + 5.0 * noise)


def test_a_corner_is_two_points_and_a_corridor_with_an_end_three():
    corner = [Wall("a", (3.0, -9.0), (3.0, 2.0), 4.0), Wall("b", (-9.0, 2.0), (3.0, 2.0), 4.0)]
    near, far = mattering(seen_in(corner, HERE))
    assert near == pytest.approx((0.0, 1.95, 2.0), abs=0.01)
    assert far == pytest.approx((2.95, 0.0, 2.0), abs=0.01)
    corridor = [Wall("left", (-9.0, 1.5), (9.0, 1.5), 4.0), Wall("right", (-9.0, -1.5), (9.0, -1.5), 4.0)]
    post = [*corridor, Cylinder("post", (3.0, 0.2, 2.0), 0.3, 4.0)]
    found = mattering(seen_in(post, HERE))
    assert len(found) == 3
    assert found[2] == pytest.approx((2.71, 0.2, 2.0), abs=0.25)


def test_what_lies_behind_the_planes_matters_once_the_vehicle_is_there():
    posts = [Cylinder("left", (1.0, 1.2, 2.0), 0.2, 4.0), Cylinder("right", (1.0, -1.2, 2.0), 0.2, 4.0)]
    found = echoes(seen_in([*posts, Cylinder("ahead", (4.0, 0.0, 2.0), 0.2, 4.0)], HERE), HERE, RADIUS)
    ahead = pytest.approx((3.8, 0.0, 2.0), abs=0.05)
    assert ahead not in bounding(found, (0.0, 0.0, 2.0))
    assert ahead in bounding(found, (1.0, 0.0, 2.0))


# A few distances, each over a few sectors.
SOMEWHERE = st.floats(0.0, 8.0) | st.just(INF) | st.just(NAN)
ECHOES = st.lists(SOMEWHERE, min_size=12, max_size=12).map(lambda few: [d for d in few for _ in range(6)])


@given(ECHOES, st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.just(2.0), st.floats(-4, 4)))
@settings(max_examples=60)
def test_no_echo_is_left_on_the_near_side_of_all_planes(distances, pose):
    found = echoes(Seen(distances, NAN, NAN), pose, RADIUS)
    chosen = bounding(found, pose[:3])
    assert len(chosen) <= MOST_POINTS
    assert {point[2] for point in chosen} <= {pose[2]}
    gaps = [math.dist(point, pose[:3]) for point in chosen]
    assert gaps == pytest.approx(sorted(gaps))
    if found.around:
        assert gaps[0] == pytest.approx(min(math.dist(point, pose[:2]) for point in found.around))
    for echo in found.around:
        behind = [
            sum((e - h) * (p - h) for e, p, h in zip(echo, point, pose, strict=False)) / gap
            >= gap - 0.051 - 0.044 * math.dist(echo, pose[:2])
            for point, gap in zip(chosen, gaps, strict=True)
        ]
        assert any(behind) or (len(chosen) == MOST_POINTS and math.dist(echo, pose[:2]) >= gaps[-1] - 1e-9)


@given(ECHOES)
def test_all_points_are_finite_in_reach_and_not_the_vehicle_itself(distances):
    for point in echoes(Seen(distances, NAN, NAN), HERE, RADIUS).around:
        assert 0.4 - 1e-9 <= math.dist(point, HERE[:2]) <= REACH + 1e-9


def test_what_is_not_known_or_nothing_is_no_point():
    assert echoes(Seen(NOTHING, INF, INF), HERE, RADIUS) == Echoes()
    assert echoes(Seen((NAN,) * RING_SECTORS, NAN, NAN), HERE, RADIUS) == Echoes()
    assert bounding(Echoes(), HERE[:3]) == ()


def test_an_echo_within_the_hull_is_the_vehicles_own_and_just_outside_it_is_not():
    own, other = [INF] * 72, [INF] * 72
    own[9], other[9] = 0.39, 0.41
    assert echoes(Seen(own, 0.3, 0.3), HERE, RADIUS) == Echoes()
    assert len(echoes(Seen(other, NAN, NAN), HERE, RADIUS).around) == 1


def test_flat_ground_is_the_floors_business_and_what_stands_on_it_is_below_wherever_the_vehicle_goes():
    assert echoes(Seen(NOTHING, 2.0, NAN), HERE, RADIUS) == Echoes()
    assert echoes(Seen(NOTHING, 1.75, NAN), HERE, RADIUS) == Echoes()
    crate = echoes(Seen(NOTHING, 0.8, NAN), HERE, RADIUS)
    assert crate.ground == pytest.approx(1.2)
    assert bounding(crate, (0.5, -0.5, 1.9)) == (pytest.approx((0.5, -0.5, 1.2)),)


def test_a_ceiling_is_above_wherever_the_vehicle_goes():
    under = echoes(Seen(NOTHING, NAN, 1.5), HERE, RADIUS)
    assert bounding(under, (0.5, -0.5, 2.1)) == ((0.5, -0.5, 3.5),)


def test_what_was_seen_around_reaches_to_the_vehicles_height():
    post = echoes(Seen([2.0, *NOTHING[1:]], NAN, NAN), HERE, RADIUS)
    assert bounding(post, (0.0, 0.0, 1.4)) == ((2.0, 0.0, 1.4),)
