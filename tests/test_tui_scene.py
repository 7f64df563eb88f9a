"""The flat maps: what stands still, from above and from the side."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest
from canned_flight import canned_run
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.guide import Guide
from groundstation.training.mission import Fence
from groundstation.tui import goals, scene
from groundstation.tui.canvas import Canvas
from groundstation.tui.theme import Tone
from groundstation.tui.view import SIDE_EAST, SIDE_NORTH, TOP, View, framing, side_of, zoomed
from sim.environment.shapes import extent
from sim.scenario import Box, Cylinder, Gate, Pad, Sphere, Wall

MISSION = canned_run().mission
ABOVE = View(0.0, 0.0, 0.1, 160, 100)
metres = st.floats(-500.0, 500.0)


def tones(canvas: Canvas) -> set[Tone]:
    return {tone for row in canvas.to_rows() for text, tone in row if text.strip()}


@given(
    points=st.lists(st.tuples(metres, metres), max_size=4),
    width=st.integers(20, 400),
    height=st.integers(20, 240),
)
def test_the_view_shows_the_start_and_all_points(points, width, height):
    view = framing(None, points, width, height)
    assert view.holds([(0.0, 0.0), *points])


@given(st.integers(60, 400), st.integers(40, 240))
def test_the_view_shows_the_whole_mission(width, height):
    view = framing(MISSION, [], width, height)
    assert view.holds([(point[0], point[1]) for point in MISSION.route])
    assert view.holds([corner[:2] for obstacle in MISSION.obstacle for corner in extent(obstacle)])
    assert view.holds([MISSION.target.position[:2]])


def test_north_is_up_and_east_is_right():
    view = framing(None, [], 100, 100)
    assert float(view.x(1.0)) > float(view.x(0.0))
    assert float(view.y(1.0)) < float(view.y(0.0))


def test_both_axes_have_one_scale():
    view = framing(MISSION, [], 200, 100)
    assert float(view.x(1.0) - view.x(0.0)) == pytest.approx(float(view.y(0.0) - view.y(1.0)))


@pytest.mark.parametrize(
    ("obstacle", "reaches", "above"),
    [
        (Sphere(name="s", center=(0, 0, 2), radius=0.5), 2.9, 3.1),
        (Cylinder(name="c", center=(0, 0, 2), radius=0.5, height=4), 4.4, 4.6),
        (Box(name="b", center=(0, 0, 1.5), size=(1, 1, 3)), 3.4, 3.6),
    ],
)
def test_an_obstacle_is_beside_the_vehicle_only_at_its_altitude(obstacle, reaches, above):
    assert scene.beside(obstacle, reaches, ABOVE)
    assert not scene.beside(obstacle, above, ABOVE)


def with_world(*obstacles, pad=()):
    return msgspec.structs.replace(MISSION, obstacle=obstacles, pad=pad, route=(), target=None)


def test_a_gates_posts_are_solid_and_its_opening_is_crossed_by_lines_only():
    mission = with_world(Gate("g", (5.0, 0.0, 2.0), 3.0, 3.0, frame=0.4))
    assert scene.levels(mission, 2.0, ABOVE) == (True, True, False, False)
    view = framing(mission, [], 160, 100)
    canvas = Canvas(80, 25)
    scene.draw_world(canvas, view, mission, 2.0)
    x, post, middle = (int(view.x(5.0)), int(view.y(1.7)), int(view.y(0.0)))
    assert canvas._tones[post // 4, x // 2] == Tone.BESIDE
    assert canvas._tones[middle // 4, x // 2] != Tone.BESIDE


def test_walls_and_pads_are_within_the_view_and_drawn():
    mission = with_world(
        Wall("long", (-2.0, 12.0), (30.0, 12.0), 2.0), pad=(Pad("roof", (0.0, -15.0, 3.0), 1.0),)
    )
    view = framing(mission, [], 160, 100)
    assert view.holds([(-2.0, 11.95), (30.0, 12.05), (-1.0, -16.0), (1.0, -14.0)])
    bare, full = Canvas(80, 25), Canvas(80, 25)
    scene.draw_world(bare, view, with_world(mission.obstacle[0]), 1.0)
    scene.draw_world(full, view, mission, 1.0)
    rows, columns = np.nonzero(bare._dots != full._dots)
    assert rows.mean() == pytest.approx(float(view.y(-15.0)), abs=1.5)
    assert columns.mean() == pytest.approx(float(view.x(0.0)), abs=1.5)
    scene.label_obstacles(full, view, mission)
    assert any("long" in "".join(text for text, _ in row) for row in full.to_rows())


def test_obstacles_beside_the_vehicle_are_drawn_solid_others_as_outlines():
    view = framing(MISSION, [], 160, 100)
    low, high = Canvas(80, 25), Canvas(80, 25)
    scene.draw_world(low, view, MISSION, 2.0)
    scene.draw_world(high, view, MISSION, 20.0)
    assert Tone.BESIDE in tones(low)
    assert Tone.BESIDE not in tones(high)
    assert Tone.OBSTACLE in tones(high)
    goals.draw_ways(high, view, MISSION, Guide())
    assert {Tone.TARGET, Tone.ROUTE} <= tones(high)


def test_the_scale_is_as_long_as_it_says():
    view = View(0.0, 0.0, 0.05, 160, 80)
    canvas = Canvas(80, 20)
    scene.draw_legend(canvas, view)
    line = "".join(text for text, _ in canvas.to_rows()[-1])
    ruler = line.strip().partition("┤")[0] + "┤"
    metres_said = float(line.partition("┤")[2].split()[0])
    assert len(ruler) * 2 * view.scale == pytest.approx(metres_said, abs=2 * view.scale)


def test_from_the_side_up_is_up_and_the_mission_is_seen_at_its_longest():
    assert side_of(MISSION) is SIDE_EAST
    northward = msgspec.structs.replace(MISSION, route=((0.0, 30.0, 2.0),), obstacle=(), pad=(), target=None)
    assert side_of(northward) is SIDE_NORTH
    view = framing(MISSION, [], 200, 100, SIDE_EAST)
    x, y = view.dots(np.array([(3.0, 100.0, 1.0), (4.0, -100.0, 2.0)]))
    assert x[1] > x[0]
    assert y[1] < y[0]
    assert all(view.holds([view.plane.flat(point)]) for point in MISSION.route)


@given(
    st.lists(st.tuples(metres, metres), min_size=1, max_size=4), st.sampled_from((TOP, SIDE_EAST, SIDE_NORTH))
)
def test_every_plane_frames_all_points(points, plane):
    assert framing(None, [*points], 200, 120, plane).holds(points)


def test_from_the_side_what_is_in_the_vehicles_plane_is_solid():
    ball = Sphere(name="s", center=(3.0, 2.0, 2.0), radius=0.5)
    view = framing(with_world(ball), [], 160, 100, SIDE_EAST)
    assert scene.beside(ball, 2.9, view)
    assert not scene.beside(ball, 3.1, view)


def test_from_the_side_a_fence_is_two_levels_and_two_walls():
    view = framing(None, [(-12.0, 0.0), (12.0, 6.0)], 160, 100, SIDE_EAST)
    canvas = Canvas(80, 25)
    scene.draw_fence(canvas, view, Fence(radius=10.0, ceiling=5.0, floor=0.5), Tone.OBSTACLE)
    rows, columns = np.nonzero(canvas._dots)
    for level in (5.0, 0.5):
        assert np.count_nonzero(abs(rows - float(view.y(level))) < 1) > 20
    for wall in (-10.0, 10.0):
        assert np.count_nonzero(abs(columns - float(view.x(wall))) < 1) > 5


def test_zooming_in_and_out_again_comes_back():
    assert zoomed(0.1, 2) < 0.1 < zoomed(0.1, -2)
    assert zoomed(zoomed(0.1, 3), -3) == 0.1
    assert zoomed(1e9, -5) == zoomed(1e9, 0)


@given(st.floats(-50, 50), st.floats(-50, 50))
def test_a_map_that_follows_stays_while_the_vehicle_is_in_its_middle(x, y):
    view = View(0.0, 0.0, 0.2, 200, 100)
    inside = abs(x) <= 0.25 * 40 and abs(y) <= 0.25 * 20
    assert view.calm((x, y)) == inside
