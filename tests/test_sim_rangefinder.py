"""The ring of rays around the vehicle and the one that looks down, against the world's own rays."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_sim_world import OBSTACLES, POINTS

from sim.environment.rangefinder import SECTORS, below, ring
from sim.environment.world import World
from sim.scenario import Box, Sphere, Wall


@given(st.lists(OBSTACLES, max_size=5), POINTS, st.floats(-math.pi, math.pi), st.integers(1, 100))
def test_every_ray_of_the_ring_is_a_ray_of_the_world(obstacles, point, yaw, count):
    world = World(obstacles)
    distances = ring(world, (*point, yaw), count, limit=8.0)
    assert len(distances) == count
    for number, distance in enumerate(distances):
        angle = yaw + number * math.tau / count
        exact = world.ray(point, (math.cos(angle), math.sin(angle), 0.0), 100.0)
        # A ray that grazes may go either way by rounding.
        nudged = [
            world.ray(point, (math.cos(angle + d), math.sin(angle + d), 0.0), 100.0) for d in (-1e-7, 1e-7)
        ]
        expected = [value if value <= 8.0 else math.inf for value in (exact, *nudged)]
        assert any(distance == pytest.approx(value, abs=1e-4) for value in expected)


def test_ray_0_looks_forward_and_they_count_counter_clockwise():
    world = World([Sphere("ahead", (0.0, 5.0, 2.0), 1.0), Box("left", (-3.0, 0.0, 2.0), (2.0, 2.0, 2.0))])
    distances = ring(world, (0.0, 0.0, 2.0, math.pi / 2))
    assert len(distances) == SECTORS
    assert distances[0] == pytest.approx(4.0)
    assert distances[SECTORS // 4] == pytest.approx(2.0)
    assert distances[SECTORS // 2] == math.inf
    assert distances[3 * SECTORS // 4] == math.inf


def test_what_is_higher_lower_or_too_far_is_not_seen():
    world = World([Wall("wall", (4.0, -5.0), (4.0, 5.0), 2.0)])
    assert min(ring(world, (0.0, 0.0, 1.9, 0.0))) == pytest.approx(3.95)
    assert min(ring(world, (0.0, 0.0, 2.1, 0.0))) == math.inf
    assert min(ring(world, (0.0, 0.0, 1.9, 0.0), limit=3.9)) == math.inf


def test_inside_an_obstacle_every_ray_is_zero():
    world = World([Box("crate", (0.0, 0.0, 1.0), (2.0, 2.0, 2.0))])
    assert set(ring(world, (0.1, 0.2, 1.0, 0.3))) == {0.0}


def test_below_is_the_ground_or_what_stands_on_it():
    world = World([Box("crate", (0.0, 0.0, 0.5), (2.0, 2.0, 1.0))])
    assert below(world, (0.5, 0.5, 3.0)) == pytest.approx(2.0)
    assert below(world, (1.5, 0.5, 3.0)) == 3.0
    assert below(world, (1.5, 0.5, 3.0), limit=2.5) == math.inf
    assert below(world, (1.5, 0.5, -0.01)) == 0.0
