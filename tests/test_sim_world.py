"""Distance to obstacles against brute force, and a sphere that is stopped by them at any speed."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.environment.collision import SKIN, Collider, bounced, without
from sim.environment.shapes import flown_through, primitives
from sim.environment.world import World
from sim.scenario import Box, Cylinder, Gate, Sphere, Wall

POINTS = st.tuples(*[st.floats(-6, 6)] * 3)
SIZES = st.floats(0.2, 4)
CENTERS = st.tuples(*[st.floats(-2, 2)] * 3)
BOXES = st.builds(Box, st.just("box"), CENTERS, st.tuples(SIZES, SIZES, SIZES), st.floats(-180, 180))
CYLINDERS = st.builds(Cylinder, st.just("cylinder"), CENTERS, SIZES, SIZES)
SPHERES = st.builds(Sphere, st.just("sphere"), CENTERS, SIZES)
SOLIDS = st.one_of(BOXES, CYLINDERS, SPHERES)
FLAT = st.tuples(*[st.floats(-5, 5)] * 2)
WALLS = st.builds(Wall, st.just("wall"), FLAT, FLAT.map(lambda end: (end[0] + 11.0, end[1])), SIZES, SIZES)
GATES = st.builds(
    Gate, st.just("gate"), st.tuples(*[st.floats(-2, 2)] * 2, st.floats(2, 3)), SIZES, SIZES,
    st.floats(-180, 180), st.floats(0.02, 0.5), st.booleans(),
)  # fmt: skip
OBSTACLES = st.one_of(SOLIDS, WALLS, GATES)
HEADINGS = st.tuples(st.floats(-math.pi, math.pi), st.floats(-1.5, 1.5)).map(
    lambda angles: (
        math.cos(angles[0]) * math.cos(angles[1]),
        math.sin(angles[0]) * math.cos(angles[1]),
        math.sin(angles[1]),
    )
)
GRID = np.linspace(-0.5, 0.5, 41)


def surface(solid):
    """Return points all over a solid's surface, (N, 3), and the largest gap between neighbours, m."""
    a, b = (axis.ravel() for axis in np.meshgrid(GRID, GRID))
    if isinstance(solid, Box):
        faces = [
            np.roll(np.stack([a, b, np.full_like(a, s)], 1), k, 1) for s in (-0.5, 0.5) for k in range(3)
        ]
        local = np.concatenate(faces) * solid.size
        c, s = math.cos(math.radians(solid.yaw_deg)), math.sin(math.radians(solid.yaw_deg))
        local = local @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        gap = max(solid.size) / 40
    elif isinstance(solid, Cylinder):
        angle = a * math.tau
        wall = np.stack([np.cos(angle), np.sin(angle), b], 1) * (solid.radius, solid.radius, solid.height)
        rim = (b + 0.5) * solid.radius
        caps = [
            np.stack([np.cos(angle) * rim, np.sin(angle) * rim, np.full_like(a, s * solid.height)], 1)
            for s in (-0.5, 0.5)
        ]
        local = np.concatenate([wall, *caps])
        gap = max(solid.radius * math.tau, solid.height) / 40
    else:
        angle, up = a * math.tau, b * math.pi
        local = (
            np.stack([np.cos(angle) * np.cos(up), np.sin(angle) * np.cos(up), np.sin(up)], 1) * solid.radius
        )
        gap = solid.radius * math.tau / 40
    return local + solid.center, gap


def is_inside(solid, point):
    x, y, z = (p - c for p, c in zip(point, solid.center, strict=True))
    if isinstance(solid, Sphere):
        return math.hypot(x, y, z) < solid.radius
    if isinstance(solid, Cylinder):
        return math.hypot(x, y) < solid.radius and abs(z) < solid.height / 2
    yaw = math.radians(-solid.yaw_deg)
    u, v = math.cos(yaw) * x - math.sin(yaw) * y, math.sin(yaw) * x + math.cos(yaw) * y
    return all(abs(value) < size / 2 for value, size in zip((u, v, z), solid.size, strict=True))


@settings(deadline=None)
@given(SOLIDS, POINTS)
def test_distance_is_that_to_the_nearest_point_of_the_surface(solid, point):
    points, gap = surface(solid)
    brute = float(np.min(np.linalg.norm(points - point, axis=1)))
    distance, name = World([solid]).clearance(point)
    assert name == solid.name
    assert abs(distance) <= brute + 1e-9
    assert abs(distance) >= brute - gap
    assert (distance < 0) == is_inside(solid, point) or abs(distance) < 1e-9


@given(SOLIDS, POINTS)
def test_the_normal_is_the_way_out(solid, point):
    """Where the distance is smooth, a small way along the normal adds just that way."""
    world = World([solid])
    nearest = world.nearest(point)
    assert math.hypot(*nearest.normal) == pytest.approx(1.0)
    if nearest.distance > 1e-3:
        further = tuple(p + 0.05 * n for p, n in zip(point, nearest.normal, strict=True))
        assert world.clearance(further)[0] == pytest.approx(nearest.distance + 0.05, abs=1e-9)


@given(SOLIDS, POINTS, POINTS)
def test_distance_never_changes_more_than_the_way(solid, a, b):
    world = World([solid])
    assert abs(world.clearance(a)[0] - world.clearance(b)[0]) <= math.dist(a, b) + 1e-9


def test_the_nearest_of_several_is_named():
    world = World([Sphere("far", (10.0, 0.0, 1.0), 1.0), Sphere("near", (3.0, 0.0, 1.0), 1.0)])
    assert world.clearance((0.0, 0.0, 1.0)) == (2.0, "near")


def test_an_empty_world_is_infinitely_clear_and_a_floor_is_below():
    assert World().clearance((0.0, 0.0, 1.0)) == (math.inf, "")
    assert World().nearest((0.0, 0.0, 1.0)).normal == (0.0, 0.0, 0.0)
    assert World(floor=True).clearance((5.0, 5.0, 1.5)) == (1.5, "floor")


@given(OBSTACLES, POINTS)
def test_the_nearest_point_is_on_the_surface_at_the_distance(obstacle, point):
    world = World([obstacle])
    nearest = world.nearest(point)
    assert math.dist(point, nearest.point) == pytest.approx(abs(nearest.distance), abs=1e-9)
    assert any(abs(solid.distance(*nearest.point)) < 1e-9 for solid in world.solids)


def test_in_an_empty_world_the_nearest_point_is_the_point():
    assert World().nearest((1.0, 2.0, 3.0)).point == (1.0, 2.0, 3.0)


def test_a_ray_ends_at_the_first_surface_or_its_limit():
    world = World([Box("crate", (0.0, 0.0, 0.5), (2.0, 2.0, 1.0))])
    assert world.ray((0.3, 0.2, 4.0), (0.0, 0.0, -1.0), 10.0) == pytest.approx(3.0)
    assert world.ray((5.0, 0.2, 4.0), (0.0, 0.0, -1.0), 4.0) == 4.0
    assert World(floor=True).ray((5.0, 0.2, 4.0), (0.6, 0.0, -0.8), 10.0) == pytest.approx(5.0)
    assert World(floor=True).ray((5.0, 0.2, 4.0), (0.6, 0.0, 0.8), 10.0) == 10.0
    assert World().ray((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 7.0) == 7.0


@given(st.lists(OBSTACLES, max_size=3), POINTS, HEADINGS)
def test_a_ray_goes_through_free_space_and_ends_on_a_surface(obstacles, origin, heading):
    world = World(obstacles)
    length = world.ray(origin, heading, 20.0)

    def clearance(along):
        return world.clearance(tuple(o + along * h for o, h in zip(origin, heading, strict=True)))[0]

    if length == 0.0:
        assert clearance(0.0) <= 1e-9
        return
    assert all(clearance(length * share) > -1e-7 for share in np.linspace(0.0, 1.0, 60))
    assert length == 20.0 or abs(clearance(length)) < 1e-7


# Composites


def test_a_wall_is_as_long_high_and_thick_as_it_says():
    world = World([Wall("wall", (1.0, 1.0), (4.0, 5.0), 2.0, 0.2)])
    assert world.clearance((2.5, 3.0, 1.0))[0] == pytest.approx(-0.1)
    assert world.clearance((1.0 - 0.6, 1.0 - 0.8, 1.0))[0] == pytest.approx(1.0)
    assert world.clearance((2.5, 3.0, 5.0)) == (pytest.approx(3.0), "wall")
    assert world.clearance((2.5 - 0.8, 3.0 + 0.6, 1.0))[0] == pytest.approx(0.9)


@given(GATES, st.floats(-0.499, 0.499), st.floats(-0.499, 0.499), st.floats(-3, 3))
def test_the_opening_of_a_gate_is_open_as_wide_and_high_as_it_says(gate, across, up, along):
    yaw = math.radians(gate.yaw_deg)
    point = (
        gate.center[0] + math.cos(yaw) * along - math.sin(yaw) * across * gate.width,
        gate.center[1] + math.sin(yaw) * along + math.cos(yaw) * across * gate.width,
        gate.center[2] + up * gate.height,
    )
    distance, name = World([gate]).clearance(point)
    assert name == "gate"
    assert distance > 0.0
    edges = [(0.5 - abs(across)) * gate.width, (0.5 - up) * gate.height]
    edges += [(0.5 + up) * gate.height] if gate.sill else []
    if abs(along) <= 0.5 * gate.frame:
        assert distance == pytest.approx(min(edges), abs=1e-9)


def test_a_gate_has_a_sill_or_posts_down_to_the_ground():
    hanging, standing = (Gate("g", (0.0, 0.0, 2.0), 1.0, 1.0, sill=sill) for sill in (True, False))
    assert len(primitives(hanging)) == 4
    assert len(primitives(standing)) == 3
    assert World([hanging]).clearance((0.0, 0.0, 1.45))[0] == pytest.approx(-0.05)
    assert World([hanging]).clearance((0.0, 0.55, 0.5))[0] > 0.8
    assert World([standing]).clearance((0.0, 0.0, 1.45))[0] == pytest.approx(0.5)
    assert World([standing]).clearance((0.0, 0.55, 0.5))[0] == pytest.approx(-0.05)


def test_a_gate_is_flown_through_from_either_side_and_not_past():
    gate = Gate("g", (5.0, 1.0, 2.0), 2.0, 1.0, yaw_deg=90.0)
    assert flown_through(gate, (5.5, 0.0, 2.0), (5.5, 3.0, 2.0))
    assert flown_through(gate, (5.5, 3.0, 2.0), (5.5, 0.0, 2.0))
    assert not flown_through(gate, (5.5, 0.0, 2.0), (5.5, 0.9, 2.0))
    assert not flown_through(gate, (6.5, 0.0, 2.0), (6.5, 3.0, 2.0))
    assert not flown_through(gate, (5.5, 0.0, 2.6), (5.5, 3.0, 2.6))
    assert not flown_through(gate, (5.5, 0.0, 2.0), (5.5, 0.0, 2.0))


# Collision

WALL = Box("wall", (5.0, 0.0, 0.0), (0.01, 400.0, 400.0))


@given(st.floats(0.05, 2.0), st.floats(0.01, 100.0), st.floats(-1.2, 1.2))
def test_no_step_is_long_enough_to_pass_a_thin_wall(radius, length, slant):
    collider = Collider(World([WALL]), radius)
    position = (0.0, 0.0, 0.0)
    for _ in range(int(10.0 / (length * math.cos(slant))) + 2):
        way = (length * math.cos(slant), length * math.sin(slant), 0.0)
        position = collider.travel(position, tuple(p + w for p, w in zip(position, way, strict=True)))
        assert position[0] <= 5.0 - 0.005 - radius + 1e-9
    assert position[0] == pytest.approx(5.0 - 0.005 - radius, abs=2 * SKIN)


@settings(deadline=None)
@given(st.lists(OBSTACLES, min_size=1, max_size=4), st.lists(POINTS, min_size=2, max_size=30))
def test_however_it_moves_the_sphere_stays_outside(solids, targets):
    radius = 0.3
    world = World(solids)
    position = (20.0, 20.0, 20.0)
    collider = Collider(world, radius)
    for target in targets:
        way = tuple(t - p for t, p in zip(target, position, strict=True))
        position = collider.travel(position, tuple(p + w for p, w in zip(position, way, strict=True)))
        assert world.clearance(position)[0] >= radius - 1e-6


def test_a_contact_is_told_once_until_it_is_left():
    collider = Collider(World([WALL]), 0.5)
    struck = []
    position = (4.0, 0.0, 0.0)
    for step in itertools.chain([0.05] * 40, [-0.001] * 10, [0.05] * 10, [-0.05] * 10, [0.05] * 20):
        position = collider.travel(position, (position[0] + step, position[1], position[2]))
        struck += [strike.name for strike in collider.struck]
    assert struck == ["wall", "wall"]


def test_it_slides_along_a_wall_and_stops_in_a_corner():
    collider = Collider(World([WALL, Box("side", (0.0, 5.0, 0.0), (40.0, 0.01, 40.0))]), 0.5)
    position = (4.4, 0.0, 0.0)
    for _ in range(20):
        position = collider.travel(position, (position[0] + 0.1, position[1] + 0.1, position[2]))
    assert position == pytest.approx((4.494, 2.0, 0.0), abs=3e-3)
    for _ in range(40):
        position = collider.travel(position, (position[0] + 0.1, position[1] + 0.1, position[2] + 0.1))
    assert position[:2] == pytest.approx((4.494, 4.494), abs=3e-3)
    assert len(collider.normals) >= 2


def test_far_from_everything_a_motion_is_the_motion():
    collider = Collider(World([WALL]), 0.5)
    assert collider.travel((0.0, 0.0, 0.0), (1.0, 2.0, -3.0)) == (1.0, 2.0, -3.0)
    assert not collider.normals


@given(st.floats(0.02, 0.3), st.floats(-0.49, 0.49), st.booleans())
def test_at_50_metres_a_second_a_gate_lets_through_its_opening_and_nothing_else(frame, aside, sill):
    """One of 250 steps a second is 0.2 m then: up to ten times as long as the frame is thick."""
    gate = Gate("gate", (5.0, 0.0, 3.0), 2.0, 2.0, frame=frame, sill=sill)
    radius, step = 0.3, 50.0 * 0.004

    def flown(y, z):
        collider = Collider(World([gate]), radius)
        position, struck = (0.0, y, z), []
        for _ in range(50):
            position = collider.travel(position, (position[0] + step, position[1], position[2]))
            struck += collider.struck
        return position, struck

    position, struck = flown(aside, 3.0)
    assert (position[0], struck) == (pytest.approx(10.0), [])
    for y, z in ((1.0 + 0.5 * frame, 3.0), (-1.0 - 0.5 * frame, 3.0), (aside, 4.0 + 0.5 * frame)):
        position, struck = flown(y, z)
        assert position[0] == pytest.approx(5.0 - 0.5 * frame - radius, abs=2 * SKIN)
        assert [strike.name for strike in struck] == ["gate"]
        assert struck[0].normal == pytest.approx((-1.0, 0.0, 0.0))


def test_a_gate_touched_at_two_of_its_parts_is_one_contact():
    collider = Collider(World([Gate("gate", (5.0, 0.0, 3.0), 0.5, 0.5)]), 0.3)
    position = collider.travel((4.0, 0.0, 3.0), (6.0, 0.0, 3.0))
    assert position[0] < 5.0
    assert [strike.name for strike in collider.struck] == ["gate"]
    collider.travel(position, (5.0, 0.1, 3.1))
    assert not collider.struck


speeds = st.tuples(*[st.floats(-20, 20)] * 3)


@given(OBSTACLES, speeds, st.floats(0, 1))
def test_a_bounce_gives_back_what_restitution_says_and_leaves_the_rest(obstacle, velocity, restitution):
    collider = Collider(World([obstacle]), 0.3)
    collider.travel((11.0, 0.0, 11.0), primitives(obstacle)[0].center)
    assert collider.struck
    (name, normal), *_ = collider.struck
    after = bounced(velocity, collider.struck[:1], restitution)
    into = sum(v * n for v, n in zip(velocity, normal, strict=True))
    out = sum(v * n for v, n in zip(after, normal, strict=True))
    assert name == obstacle.name
    assert out == pytest.approx(-restitution * into if into < -0.2 else into, abs=1e-9)
    along = [v - into * n for v, n in zip(velocity, normal, strict=True)]
    assert [v - out * n for v, n in zip(after, normal, strict=True)] == pytest.approx(along, abs=1e-9)
    assert math.hypot(*without(after, [normal])) <= math.hypot(*velocity) + 1e-9
