"""Distances of many points at once are those of one point at a time."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_sim_world import OBSTACLES, POINTS

from sim.environment.field import Field
from sim.environment.world import World
from sim.scenario import Cylinder, Sphere

WORLDS = st.builds(
    lambda obstacles, floor: World(obstacles, floor=floor), st.lists(OBSTACLES, max_size=4), st.booleans()
)


@given(WORLDS, st.lists(POINTS, min_size=1, max_size=20))
def test_it_agrees_with_the_world(world, points):
    rows = np.array(points)
    field = Field(world)
    distances, nearest = field.distance(rows), field.nearest(rows)
    assert distances.shape == (len(points),)
    assert nearest.shape == rows.shape
    for point, distance, near in zip(points, distances, nearest, strict=True):
        assert distance == pytest.approx(world.clearance(point)[0], abs=1e-9)
        if math.isfinite(distance):
            assert math.dist(point, near) == pytest.approx(abs(distance), abs=1e-9)
            assert min(abs(solid.distance(*near)) for solid in world.solids) < 1e-9


@given(WORLDS, POINTS)
def test_where_one_part_is_clearly_nearest_the_point_is_the_same(world, point):
    distances = sorted(solid.distance(*point) for solid in world.solids)
    if (
        len(distances) < 1
        or distances[0] < 1e-6
        or (len(distances) > 1 and distances[1] - distances[0] < 1e-6)
    ):
        return
    assert Field(world).nearest(np.array([point]))[0] == pytest.approx(world.nearest(point).point, abs=1e-9)


def test_in_an_empty_world_all_is_far():
    points = np.zeros((3, 3))
    assert np.all(Field(World()).distance(points) == np.inf)
    assert np.array_equal(Field(World()).nearest(points), points)


def test_the_middles_of_round_things_have_a_way_out():
    for part in (Sphere("s", (1.0, 2.0, 3.0), 2.0), Cylinder("c", (1.0, 2.0, 3.0), 1.0, 9.0)):
        middle = np.array([part.center])
        near = Field(World([part])).nearest(middle)[0]
        assert math.dist(near, part.center) == pytest.approx(part.radius)
