"""What moves on the map: the vehicle and where it will be, the hand, echoes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.messages import RING_SECTORS
from groundstation.tui import moving
from groundstation.tui.canvas import Canvas
from groundstation.tui.theme import Tone
from groundstation.tui.view import SIDE_EAST, View, framing

VIEW = View(0.0, 0.0, 0.1, 160, 160)
HERE = (0.0, 0.0, 2.0, 0.0)
anything = st.floats(-1e300, 1e300) | st.sampled_from((math.nan, math.inf, -math.inf))


def tones(canvas: Canvas) -> set[Tone]:
    return {tone for row in canvas.to_rows() for text, tone in row if text.strip()}


def dots(canvas: Canvas) -> set[tuple[int, int]]:
    """Return the dots set, as column and row from the middle."""
    rows, columns = np.nonzero(canvas._dots)
    return {(int(column) - 80, int(row) - 80) for row, column in zip(rows, columns, strict=True)}


def predicted(pose: tuple[float, float, float], stop: tuple[float, float]) -> Canvas:
    canvas = Canvas(80, 40)
    east, north, yaw = pose
    moving.draw_predicted(canvas, VIEW, HERE, (east, north, 2.0, yaw), (*stop, 2.0))
    return canvas


@pytest.mark.parametrize(
    ("yaw", "axis", "side"), [(0.0, 0, 1), (math.pi, 0, -1), (math.pi / 2, 1, -1), (-math.pi / 2, 1, 1)]
)
def test_the_arrowhead_points_where_the_vehicle_heads(yaw, axis, side):
    view = View(0.0, 0.0, 0.1, 120, 120)
    canvas = Canvas(60, 30)
    moving.draw_vehicle(canvas, view, (0.0, 0.0, 2.0, yaw))
    rows, columns = np.nonzero(canvas._dots)
    reach = side * ((columns, rows)[axis] - 59.5)
    assert reach.max() > 1.3 * -reach.min()
    assert tones(canvas) == {Tone.VEHICLE}


def test_a_vehicle_that_is_nowhere_is_not_drawn():
    view = framing(None, [], 80, 80)
    canvas = Canvas(40, 20)
    moving.draw_vehicle(canvas, view, (math.nan, 0.0, 0.0, 0.0))
    moving.draw_hand(canvas, view, (0.0, math.nan, 0.0), (1.0, 1.0, 0.0), 1.5, taut=False)
    moving.draw_trail(canvas, view, np.empty((0, 4)), 0.0)
    assert tones(canvas) == set()


def test_the_leash_is_drawn_taut_as_a_warning():
    view = framing(None, [], 80, 80)
    slack, taut = Canvas(40, 20), Canvas(40, 20)
    moving.draw_hand(slack, view, (0.0, 0.0, 2.0), (1.0, 0.0, 2.0), 1.5, taut=False)
    moving.draw_hand(taut, view, (0.0, 0.0, 2.0), (1.5, 0.0, 2.0), 1.5, taut=True)
    assert Tone.HAND in tones(slack)
    assert Tone.WARN not in tones(slack)
    assert tones(taut) == {Tone.WARN}


def test_where_the_vehicle_will_be_is_a_hollow_arrowhead_there():
    canvas = predicted((3.0, 0.0, 0.0), (3.0, 0.0))
    rows, columns = np.nonzero(canvas._dots)
    assert columns.max() == pytest.approx(79.5 + 30 + 8, abs=1)
    assert columns.min() == pytest.approx(79.5 + 30 - 0.6 * 8, abs=1)
    solid = Canvas(80, 40)
    moving.draw_vehicle(solid, VIEW, (3.0, 0.0, 2.0, 0.0))
    assert len(rows) < 0.7 * np.count_nonzero(solid._dots)
    assert tones(canvas) == {Tone.VEHICLE}


def test_without_a_delay_that_shows_nothing_is_predicted():
    assert dots(predicted((0.15, 0.0, 0.0), (0.4, 0.0))) == set()


def test_where_it_can_stop_is_a_cross_at_the_end_of_a_dotted_line():
    drawn = dots(predicted((0.0, 0.0, 0.0), (0.0, -4.0)))
    middle = (min(drawn, key=lambda dot: abs(dot[1] - 40))[0], 40)
    arms = {(column, row) for column, row in drawn if row > 37}
    assert {(middle[0] + i, 40 + j) for i in (-2, 2) for j in (-2, 2)} & {
        (column, row) for column, row in arms
    }
    line = [row for column, row in drawn if 5 < row < 35]
    assert 10 < len(line) < 20
    assert {column for column, row in drawn if 5 < row < 35} <= {-1, 0}


@given(east=anything, north=anything, yaw=anything, far=anything)
def test_a_forecast_of_any_numbers_can_be_drawn(east, north, yaw, far):
    canvas = predicted((east, north, yaw), (far, north))
    if not all(map(math.isfinite, (east, north, yaw, far))):
        assert dots(canvas) == set()


def test_echoes_are_where_the_sensors_see_them_turned_with_the_vehicle():
    ring = [math.inf] * RING_SECTORS
    ring[0] = ring[RING_SECTORS // 4] = 2.0
    ring[1] = math.nan
    canvas = Canvas(80, 40)
    moving.draw_echoes(canvas, VIEW, (1.0, 0.0, 2.0, math.pi / 2), ring, Tone.WARN)
    ahead, left = (10, -20), (-10, 0)
    drawn = dots(canvas)
    assert len(drawn) == 2
    for wanted in (ahead, left):
        assert any(math.dist(dot, wanted) < 1.5 for dot in drawn)
    assert tones(canvas) == {Tone.WARN}


def test_the_way_flown_is_dimmer_the_older_it_is():
    points = np.array([(x, 0.0, 2.0, x) for x in np.arange(0.0, 60.0, 1.0)])
    tones_shown = moving.tones_by_age(60.0 - points[:, 3])
    order = [Tone.FADED, Tone.TRAIL, Tone.VEHICLE]
    assert [tone for i, tone in enumerate(tones_shown) if i == 0 or tone != tones_shown[i - 1]] == order
    canvas = Canvas(80, 40)
    moving.draw_trail(canvas, View(30.0, 0.0, 0.5, 160, 160), points, 60.0)
    assert tones(canvas) == set(order)


def test_from_the_side_the_hand_is_at_its_altitude():
    view = View(0.0, 2.0, 0.1, 160, 160, SIDE_EAST)
    canvas = Canvas(80, 40)
    moving.draw_hand(canvas, view, (0.0, 9.0, 2.0), (0.0, -9.0, 3.0), 0.5, taut=False)
    rows, columns = np.nonzero(canvas._dots)
    assert rows.min() == pytest.approx(float(view.y(3.0)) - 2, abs=1)
    assert columns.max() - columns.min() <= 11
