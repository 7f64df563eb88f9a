"""The world from within: what a camera sees, what hides what, and what the views show."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
from canned_flight import START, CannedFlight, canned_run
from hypothesis import given
from hypothesis import strategies as st

from groundstation.messages import Preset
from groundstation.training.mission import Fence
from groundstation.tui import wireframe
from groundstation.tui.camera import NEAR_M, Camera, before
from groundstation.tui.canvas import Canvas
from groundstation.tui.frame import Frame
from groundstation.tui.hand import CENTRED
from groundstation.tui.inside import camera, draw_inside
from groundstation.tui.perspective import Lines, draw, visible
from groundstation.tui.theme import Tone
from groundstation.tui.track import History, Track
from sim.scenario import Box, Cylinder, Gate, Sphere

RUN = canned_run()
WIDTH, HEIGHT = 160, 96
metres = st.floats(-30.0, 30.0)
angles = st.floats(-math.pi, math.pi)
places = st.tuples(metres, metres, metres)
BODIES = (
    Box(name="box", center=(5.0, 0.0, 1.0), size=(1.0, 2.0, 2.0), yaw_deg=30.0),
    Cylinder(name="pole", center=(5.0, 0.0, 1.0), radius=0.5, height=2.0),
    Sphere(name="ball", center=(5.0, 0.0, 1.0), radius=0.8),
)


def eye(place=(0.0, 0.0, 1.0), yaw=0.0, pitch=0.0, roll=0.0) -> Camera:
    return Camera(place, yaw, pitch, roll, 80.0, WIDTH, HEIGHT)


def world(*obstacles):
    return msgspec.structs.replace(RUN.mission, obstacle=obstacles, pad=(), route=(), target=None)


def frame(seconds: float = 12.0, **edits) -> Frame:
    flight = CannedFlight(RUN)
    flight.advance(seconds)
    shown = flight.snapshot()
    for name, value in edits.items():
        setattr(shown.vehicle, name, value)
    track = Track()
    for step in range(40):
        track.add(0.1 * step - 4.0, 0.0, 2.0, START + 0.2 * step)
    return Frame(
        snapshot=shown, run=RUN, started=START, states={}, stick=CENTRED, hindrances={}, guarded_by="",
        notes=(), track=track, history=History(),
    )  # fmt: skip


def tones(canvas: Canvas) -> set[Tone]:
    return {tone for row in canvas.to_rows() for text, tone in row if text.strip()}


def text(canvas: Canvas) -> str:
    return "\n".join("".join(text for text, _ in row) for row in canvas.to_rows())


def test_ahead_is_the_middle_left_is_left_and_up_is_up():
    x, y = eye(yaw=math.pi / 2).dots(np.array([(0.0, 9.0, 1.0), (-1.0, 9.0, 1.0), (0.0, 9.0, 2.0)]))
    assert (x[0], y[0]) == pytest.approx(((WIDTH - 1) / 2, (HEIGHT - 1) / 2))
    assert x[1] < x[0]
    assert y[2] < y[0]


def test_nose_up_lowers_the_horizon_and_a_roll_to_the_right_lifts_its_right_end():
    far = np.array([(1000.0, 300.0, 1.0), (1000.0, 0.0, 1.0), (1000.0, -300.0, 1.0)])
    assert eye(pitch=0.2).dots(far)[1][1] > eye().dots(far)[1][1]
    left, _, right = eye(roll=0.2).dots(far)[1]
    assert right < left


def test_what_is_behind_is_nowhere():
    x, y = eye().dots(np.array([(-1.0, 0.0, 1.0), (0.0, 0.0, 1.0)]))
    assert np.isnan(x).all()
    assert np.isnan(y).all()


@given(places, places, places, angles, st.floats(-1.4, 1.4), angles)
def test_a_line_is_cut_where_it_passes_the_eye_and_stays_on_itself(start, end, place, yaw, pitch, roll):
    camera_ = eye(place, yaw, pitch, roll)
    segments = camera_.seen(np.array([[start, end]]))
    cut, seen = before(segments)
    assert seen[0] == (segments[0, :, 2] >= NEAR_M).any()
    if seen[0]:
        assert (cut[0, :, 2] >= NEAR_M * (1 - 1e-9)).all()
        way, part = segments[0, 1] - segments[0, 0], cut[0, 1] - cut[0, 0]
        assert np.linalg.norm(np.cross(way, part)) <= 1e-6 * (1 + way @ way)
        assert way @ part >= -1e-9


@given(places, angles, st.floats(-1.4, 1.4), angles)
def test_a_cameras_axes_are_at_right_angles(place, yaw, pitch, roll):
    axes = eye(place, yaw, pitch, roll).axes()
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1.0)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_a_body_hides_what_is_behind_it_and_nothing_else(body):
    solids = wireframe.solids(world(body))
    points = np.array([(9.0, 0.0, 1.0), (3.0, 0.0, 1.0), (9.0, 6.0, 1.0), (9.0, 0.0, 6.0), (-9.0, 0.0, 1.0)])
    assert solids.hide((0.0, 0.0, 1.0), points).tolist() == [True, False, False, False, False]


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_an_eye_within_a_body_sees_out(body):
    solids = wireframe.solids(world(body))
    assert not solids.hide((5.0, 0.0, 1.0), np.array([(9.0, 0.0, 1.0), (0.0, 0.0, 1.0)])).any()


@given(places, st.lists(places, min_size=1, max_size=5))
def test_hiding_is_the_same_as_walking_along_the_line_of_sight(place, points):
    body = BODIES[0]
    solids = wireframe.solids(world(body))
    hidden = solids.hide(place, np.array(points))
    shares = np.linspace(0.0, 1.0, 400)[1:-4]
    turn, half = math.radians(body.yaw_deg), np.array(body.size) / 2
    c, s = math.cos(turn), math.sin(turn)

    def depth(points_: np.ndarray) -> np.ndarray:
        along = (points_ - np.array(body.center)) @ np.array([(c, -s, 0), (s, c, 0), (0, 0, 1)])
        return (half - abs(along)).min(axis=-1)

    if depth(np.array(place)) > -1e-6:
        return
    for point, said in zip(points, hidden, strict=True):
        deepest = depth(np.array(place) + shares[:, None] * (np.array(point) - np.array(place))).max()
        if deepest > 1e-6:
            assert said
        elif deepest < -0.2:
            assert not said


def test_the_far_edges_of_a_box_are_not_drawn_and_a_target_behind_it_is_dotted():
    box = Box(name="box", center=(5.0, 0.0, 1.0), size=(2.0, 2.0, 2.0))
    solids = wireframe.solids(world(box))
    all_edges = wireframe.contours(box, (0.0, 0.0, 1.0))
    with_hiding, without = Canvas(80, 24), Canvas(80, 24)
    draw(with_hiding, eye(), solids, [Lines(all_edges, Tone.BESIDE)])
    draw(without, eye(), wireframe.solids(None), [Lines(all_edges, Tone.BESIDE)])
    assert 0 < np.count_nonzero(with_hiding._dots) < 0.8 * np.count_nonzero(without._dots)
    mark = Lines(wireframe.diamond(np.array([12.0, 0.0, 1.0]), 0.5), Tone.TARGET, through=True)
    seen, through = Canvas(80, 24), Canvas(80, 24)
    draw(seen, eye(), wireframe.solids(None), [mark])
    draw(through, eye(), solids, [mark])
    assert 0 < np.count_nonzero(through._dots) < 0.6 * np.count_nonzero(seen._dots)
    assert visible(eye(), solids, np.array([12.0, 0.0, 1.0])) is None
    assert visible(eye(), solids, np.array([12.0, 5.0, 1.0])) is not None


@pytest.mark.parametrize(
    "body", [*BODIES, Gate("g", (5.0, 0.0, 2.0), 2.0, 2.0, frame=0.2)], ids=lambda b: b.name
)
def test_the_lines_of_an_obstacle_lie_on_it(body):
    from sim.environment.shapes import extent

    lower, upper = (np.array(corner) for corner in extent(body))
    lines = wireframe.contours(body, (0.0, 0.5, 1.5)).reshape(-1, 3)
    reach = 0.6 if isinstance(body, Gate) else 1e-6
    assert (lines >= lower - reach).all()
    assert (lines <= upper + reach).all()


@pytest.mark.parametrize("chase", [True, False])
def test_the_views_show_ground_horizon_obstacles_and_target(chase):
    shown = frame(8.0)
    seen = camera(shown, 100, 40, 1.0, chase=chase)
    canvas = Canvas(100, 40)
    draw_inside(canvas, shown, seen, wireframe.solids(RUN.mission), Fence(floor=0.0), chase=chase)
    assert {Tone.GRID, Tone.BESIDE, Tone.TARGET, Tone.VEHICLE} <= tones(canvas)
    assert "target" in text(canvas)
    assert (Tone.TRAIL in tones(canvas)) == chase
    assert f"{round(math.degrees(math.pi / 2 - shown.snapshot.vehicle.position[3])) % 360:03d}°" in text(
        canvas
    )


def test_the_first_person_view_tilts_with_the_vehicle():
    def skyline(**edits) -> float:
        shown = frame(8.0, **edits)
        canvas = Canvas(100, 40)
        seen = camera(shown, 100, 40, 1.0, chase=False)
        draw(canvas, seen, wireframe.solids(None), [Lines(wireframe.path(ring(seen.place)), Tone.FAINT)])
        return float(np.nonzero(canvas._dots)[0].mean())

    def ring(place):
        around = np.linspace(0.0, math.tau, 90)
        return np.stack([np.cos(around), np.sin(around), np.zeros(90)], axis=1) * 2000.0 + np.array(place)

    # Nose down is a positive pitch on axes with y to the left: the horizon rises in the picture.
    assert skyline(pitch=0.2, roll=0.0) < skyline(pitch=0.0, roll=0.0) < skyline(pitch=-0.2, roll=0.0)


def test_without_a_position_there_is_no_camera():
    assert camera(frame(position=(math.nan,) * 4), 80, 24, 1.0, chase=True) is None


@given(places, angles, st.floats(0.3, 6.0), st.booleans())
def test_any_place_can_be_looked_from(place, yaw, zoom, chase):
    shown = frame(position=(*place, yaw), roll=0.3, pitch=math.nan)
    shown.snapshot.pilot.preset = Preset.ASSISTED
    canvas = Canvas(60, 20)
    seen = camera(shown, 60, 20, zoom, chase=chase)
    draw_inside(
        canvas, shown, seen, wireframe.solids(RUN.mission), Fence(radius=20.0, ceiling=5.0), chase=chase
    )
    assert len(canvas.to_rows()) == 20
