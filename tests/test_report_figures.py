"""The figures: what is drawn is what was flown, on whatever mission."""

import math
from itertools import pairwise

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure
from msgspec.structs import replace
from series_support import MISSION, RADIUS, TARGET, a_series

from groundstation.report.figures import cues, errors, force, motion, outlines, over_time, style, velocities
from groundstation.report.figures.camera import looking_at
from groundstation.report.figures.view import moments, view_of
from groundstation.review.series import approaches, lengths
from sim.environment.shapes import extent
from sim.environment.world import World
from sim.scenario import Box, Cylinder, Sphere

PLACE = st.tuples(*[st.floats(-20.0, 20.0)] * 3)
SIZE = st.floats(0.05, 5.0)
PARTS = st.one_of(
    st.builds(Box, st.just("box"), PLACE, st.tuples(SIZE, SIZE, SIZE), st.floats(-180.0, 180.0)),
    st.builds(Cylinder, st.just("cylinder"), PLACE, SIZE, SIZE),
    st.builds(Sphere, st.just("sphere"), PLACE, SIZE),
)


def drawn(draw, *arguments):
    """Return the panels of a figure, drawn as for a page."""
    with style.applied():
        figure = Figure(layout="constrained")
        draw(figure, *arguments)
        figure.draw_without_rendering()
    return figure.axes


def curves(axes):
    """Return the values of all curves over the whole time."""
    return [line.get_ydata() for line in axes.get_lines() if len(line.get_xdata()) > 2]


@given(PARTS)
def test_an_outline_reaches_as_far_as_the_obstacle(part):
    (x0, y0, z0), (x1, y1, z1) = extent(part)
    above, side = outlines.from_above(part), outlines.from_the_side(part)
    npt.assert_allclose((*above.min(axis=0), *above.max(axis=0)), (x0, y0, x1, y1), atol=0.01 * 5.0)
    npt.assert_allclose((*side.min(axis=0), *side.max(axis=0)), (x0, z0, x1, z1), atol=0.01 * 5.0)


@settings(max_examples=20)
@given(PARTS)
def test_every_face_of_an_obstacle_looks_outward(part):
    middle = np.array(part.center)
    faces = list(outlines.faces(part))
    first, second, third = (np.array([face[index] for face in faces]) for index in range(3))
    normals = np.cross(second - first, third - second)
    outward = np.array([face.mean(axis=0) for face in faces]) - middle
    assert ((normals * outward).sum(axis=1) > -1e-9).all()
    assert ((normals * outward).sum(axis=1) > 0.0).sum() >= 6


def test_the_camera_looks_at_the_middle_and_up_is_up():
    camera = looking_at(np.zeros(3), np.array((4.0, 2.0, 2.0)), -70.0, 30.0, 2.0)
    middle, above, east = camera.picture(np.array([(2.0, 1.0, 1.0), (2.0, 1.0, 2.0), (3.0, 1.0, 1.0)]))
    npt.assert_allclose(middle, (0.0, 0.0), atol=1e-12)
    assert above[1] > 0.0
    assert above[0] == pytest.approx(0.0, abs=1e-12)
    assert east[0] > 0.0


def test_what_lies_behind_an_obstacle_is_hidden():
    world = World((Sphere("ball", (0.0, 0.0, 0.0), 1.0),))
    camera = looking_at(-np.ones(3), np.ones(3), 180.0, 0.0, 3.0)
    assert list(camera.hidden(np.array([(5.0, 0.0, 0.0), (-5.0, 0.0, 0.0), (5.0, 8.0, 0.0)]), world)) == [
        True,
        False,
        False,
    ]


def test_the_views_hold_the_flight_with_all_obstacles():
    series = a_series()
    view = view_of(series, MISSION, RADIUS)
    for obstacle in MISSION.obstacle:
        low, high = extent(obstacle)
        assert (view.low[:2] < low[:2]).all()
        assert (view.high > high).all()
    assert (view.low[:2] < series.p[:, :2].min(axis=0)).all()


def test_moments_are_the_full_multiples():
    t = np.arange(0.5, 7.0, 0.02)
    npt.assert_allclose(t[moments(t, 2.0)], (2.0, 4.0, 6.0), atol=0.021)


def test_motion_draws_the_way_flown_from_the_side_and_from_above():
    series = a_series()
    _, side, _, above = sorted_panels(drawn(motion.draw, series, MISSION, RADIUS))
    assert any(np.array_equal(y, series.p[:, 2]) for y in curves(side))
    assert any(np.array_equal(y, series.p[:, 1]) for y in curves(above))
    names = {text.get_text() for text in above.texts}
    assert names >= {obstacle.name for obstacle in MISSION.obstacle}


def sorted_panels(panels):
    """Return the panels of a motion: space, side, key, above."""
    by_title = {axes.get_title(loc="left"): axes for axes in panels}
    side, above = by_title["(b)  from the side"], by_title["(c)  from above"]
    return by_title["(a)  in perspective"], side, None, above


def test_what_there_is_not_is_not_drawn():
    mission = replace(MISSION, obstacle=(), route=(), target=None)
    panels = drawn(motion.draw, a_series(obstacles=(), wind=(math.nan,) * 3), mission, RADIUS)
    *_, above = sorted_panels(panels)
    assert above.get_legend_handles_labels()[1] == ["vehicle, $p$", "hand, $p_h$", "hull, every 2 s"]
    assert not above.texts


def test_each_time_near_an_obstacle_is_shaded_and_named():
    series = a_series()
    near = list(approaches(series, force.NEAR_M))
    assert len(near) > 1
    upper, lower = drawn(force.draw, series)
    for axes in (upper, lower):
        spans = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axes.patches]
        npt.assert_allclose(spans, [approach[:2] for approach in near])
    written = {text.get_text() for text in upper.texts}
    long_enough = {approach.name for approach in near if approach.end - approach.start > 0.5}
    assert written >= long_enough


def test_force_draws_equation_5_and_what_was_felt():
    series = a_series()._replace(force=np.ones((600, 3)))
    upper, _ = drawn(force.draw, series)
    for axis in range(3):
        assert any(np.array_equal(y, series.cues["position"][:, axis]) for y in curves(upper))
    assert sum(bool((y == 1.0).all()) for y in curves(upper)) == 3


def test_cues_that_nobody_feels_are_left_out():
    (axes,) = drawn(cues.draw, a_series())
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["position", "environment"]


def test_errors_draw_what_is_left_of_the_way_and_the_bar():
    series = a_series()
    upper, lower = drawn(errors.draw, series, TARGET, 0.05)
    to_target = np.array(TARGET.position) - series.p[:, :3]
    for axis in range(3):
        assert any(np.array_equal(y, to_target[:, axis]) for y in curves(upper))
    assert any(np.allclose(y, np.maximum(lengths(to_target), 0.001)) for y in curves(lower))
    assert lower.get_yscale() == "log"
    assert "0.05 m" in {text.get_text() for text in lower.texts}


def test_velocities_draw_reference_and_executed_by_axis_and_the_wind():
    series = a_series()
    panels = drawn(velocities.draw, series)
    for part, axes in enumerate(panels[:4]):
        reference, executed = curves(axes)
        assert np.array_equal(reference, series.v_ref[:, part])
        assert np.array_equal(executed, series.executed[:, part])
    assert [float(y[0]) for y in curves(panels[4])] == [0.5, -0.2, 0.0]
    assert len(drawn(velocities.draw, a_series(wind=(math.nan,) * 3))) == 4


@given(st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=6))
def test_names_at_the_end_of_lines_never_overlap(values):
    heights = style.spread(sorted(values), 0.4)
    assert all(high - low > 0.4 - 1e-9 for low, high in pairwise(heights))
    assert np.mean(heights) == pytest.approx(np.mean(values), abs=1e-9)


def test_all_panels_share_one_axis_of_time():
    series = a_series()
    panels = Figure().subplots(2, 1)
    over_time.prepare(list(panels), series.t)
    assert {axes.get_xlim() for axes in panels} == {(series.t[0], series.t[-1])}
