"""What is next, on the screen: rings and arrows on every view, words in hint line and mission pane, the ghost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from canned_flight import CannedFlight, canned_run
from cockpit import cockpit
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace as with_

from groundstation.messages import MappingMode
from groundstation.training.director import Goal
from groundstation.training.guide import Guide, way_to
from groundstation.training.measures import Track
from groundstation.training.mission import Fence
from groundstation.tui import goals, goals_inside
from groundstation.tui.acts import ACTS
from groundstation.tui.canvas import Canvas
from groundstation.tui.directions import steering, title, way_of, whereabouts
from groundstation.tui.frame import Frame
from groundstation.tui.ghosts import draw_ghost, ghost_lines
from groundstation.tui.hand import CENTRED
from groundstation.tui.hints import next_step
from groundstation.tui.inside import camera, draw_inside
from groundstation.tui.theme import Tone
from groundstation.tui.track import History
from groundstation.tui.track import Track as Trail
from groundstation.tui.view import SIDE_EAST, View
from groundstation.tui.wireframe import solids
from sim.scenario import Gate

RUN = canned_run()
NORTH = math.pi / 2
ZERO = (0.0, 0.0, 0.0, 0.0)
VIEW = View(0.0, 0.0, 0.1, 160, 100)


def frame(
    guide: Guide | None,
    place: Sequence[float] = (0.0, 0.0, 2.0, 0.0),
    *,
    run=RUN,
    stick=CENTRED,
    velocity=ZERO,
) -> Frame:
    flight = CannedFlight(run)
    flight.advance(12.0)
    snapshot = flight.snapshot()
    snapshot.vehicle.position[:] = place
    snapshot.vehicle.velocity[:] = velocity
    snapshot.pilot.guarding = 0
    return Frame(
        snapshot=snapshot, run=run, started=1000.0, states={}, stick=stick,
        hindrances={act.name: "" for act in ACTS}, guarded_by="", notes=(), track=Trail(), history=History(),
        guide=guide,
    )  # fmt: skip


def to(x: float, y: float, z: float, **other) -> Guide:
    goal = Goal((x, y, z), 0.5, other.pop("yaw", math.nan), other.pop("say", ""))
    return Guide(**({"goal": goal, "reached": 1, "points": 5, "elapsed": 3.0} | other))


def steer(guide: Guide, **other) -> str:
    shown = frame(guide, **other)
    way = way_of(shown)
    assert way is not None
    return steering(shown, guide, way)


def text(canvas: Canvas) -> str:
    return "\n".join("".join(words for words, _ in row) for row in canvas.to_rows())


def count(canvas: Canvas, tone: Tone) -> int:
    """Return how many cells have dots of a tone."""
    drawn = np.array([[canvas._dots[4 * r : 4 * r + 4, 2 * c : 2 * c + 2].any() for c in range(canvas.columns)]
                      for r in range(canvas.rows)])  # fmt: skip
    return int(np.count_nonzero(drawn & (canvas._tones == tone)))


@pytest.mark.parametrize(
    ("at", "words"),
    [
        ((5.0, 0.0, 2.0), "5.0 m, ahead. Push ↑ forward."),
        ((0.0, 3.0, 2.0), "3.0 m, 90° left. Push ← left."),
        ((0.0, -3.0, 2.0), "3.0 m, 90° right. Push → right."),
        ((-4.0, 0.0, 2.0), "4.0 m, behind. Push ↓ back."),
        ((3.0, 3.0, 3.5), "4.5 m, 45° left, 1.5 m up. Push ↑ forward, ← left, w up."),
        ((0.0, 0.0, 0.5), "1.5 m, 1.5 m down. Push s down."),
    ],
)
def test_the_way_is_said_and_how_to_go_it(at, words):
    assert steer(to(*at)) == words


def test_another_device_has_no_keys():
    assert steer(to(3.0, 3.0, 2.0), stick=None) == "4.2 m, 45° left. Push forward and left."


def test_the_push_is_along_the_handles_own_axes():
    east = to(5.0, 0.0, 2.0)
    looking_north = (0.0, 0.0, 2.0, NORTH)
    assert "Push → right." in steer(east, place=looking_north)
    world = with_(RUN, settings=with_(RUN.settings, mapping=with_(RUN.settings.mapping, frame="world")))
    assert "Push ↑ forward." in steer(east, place=looking_north, run=world)


def test_at_the_goal_it_says_what_is_left_to_do():
    here = {"hold_s": 3.0, "held_s": 1.2}
    assert steer(to(0.1, 0.0, 2.0, **here)) == "Stay: 1.2 of 3 s. Space is standstill."
    assert steer(to(0.1, 0.0, 2.0, **here), stick=None) == "Stay: 1.2 of 3 s. The centre is standstill."
    assert steer(to(0.1, 0.0, 2.0, yaw=NORTH, hold_s=3.0)) == "There. Turn 90° left with a."
    assert steer(to(5.0, 0.0, 2.0, hold_s=3.0)).endswith("Then stay 3 s.")
    assert steer(to(0.1, 0.0, 0.0, landing=True)) == "Over the pad: s brings it down, l lands."
    assert steer(to(2.0, 0.0, 0.0, landing=True)).startswith("2.0 m, ahead. Push ↑ forward.")


def test_it_says_when_to_let_go_where_the_vehicle_is_to_stay():
    fast = {"velocity": (0.6, 0.0, 0.0, 0.0)}
    assert steer(to(0.5, 0.0, 2.0, hold_s=3.0), **fast) == "Now let go: space stops it, then stay 3 s."
    assert "Push" in steer(to(2.0, 0.0, 2.0, hold_s=3.0), **fast), "it is far yet"
    assert "Push" in steer(to(-0.6, 0.0, 2.0, hold_s=3.0), **fast), "it flies away from it"
    assert "Now" not in steer(to(0.5, 0.0, 2.0), **fast), "it is only passed"


def test_in_position_mode_the_handle_is_kept_still():
    shown = frame(to(0.1, 0.0, 2.0, hold_s=3.0))
    shown.snapshot.pilot.mapping = MappingMode.POSITION
    assert steering(shown, shown.guide, way_of(shown)).endswith("Keep the handle still.")


def test_the_hint_line_leads_to_the_goal_and_says_what_the_mission_says():
    assert next_step(frame(to(5.0, 0.0, 2.0, say="Look north."))) == (
        "2/5 5.0 m, ahead. Push ↑ forward. Look north."
    )
    assert title(to(5.0, 0.0, 2.0)) == "2/5 Fly there."
    assert title(to(5.0, 0.0, 0.0, landing=True)) == "2/5 Land on the pad."


def test_what_the_trainee_does_wrong_comes_before_the_way():
    shown = replace(frame(to(5.0, 0.0, 2.0)), coaching="Ease off.")
    assert next_step(shown) == "Ease off."
    shown.snapshot.pilot.clutched = 1
    assert "Clutch" in next_step(shown)


@given(st.tuples(*[st.floats(-60, 60)] * 3), st.floats(-math.pi, math.pi), st.floats(0, 10))
def test_words_fit_the_smallest_screen(at, yaw, hold):
    shown = frame(to(*at, yaw=1.0, hold_s=round(hold)), (0.0, 0.0, 2.0, yaw))
    assert len(f" › {next_step(shown)}".partition(" Then stay")[0]) <= 80


def drawn(guide: Guide, view: View = VIEW) -> Canvas:
    canvas = Canvas(view.width // 2, view.height // 4)
    goals.draw_goal(canvas, view, guide, 4.0)
    return canvas


def test_the_goal_is_a_ring_with_its_number():
    canvas = drawn(to(3.0, 2.0, 2.0))
    x, y = float(VIEW.x(3.0)), float(VIEW.y(2.0))
    rows, columns = np.nonzero(canvas._dots)
    radii = np.hypot(columns - x, rows - y)
    assert np.count_nonzero(abs(radii - 5.0) < 1.0) > 12
    assert "2" in text(canvas)


def test_a_heading_is_a_tick_to_where_the_nose_must_point():
    plain, ticked = drawn(to(3.0, 2.0, 2.0)), drawn(to(3.0, 2.0, 2.0, yaw=NORTH))
    rows, columns = np.nonzero(ticked._dots != plain._dots)
    assert rows.max() < float(VIEW.y(2.0)) - 4
    assert abs(columns.mean() - float(VIEW.x(3.0))) < 1.5
    from_the_side = View(0.0, 2.0, 0.1, 160, 100, SIDE_EAST)
    assert (drawn(to(3.0, 2.0, 2.0), from_the_side)._dots
            == drawn(to(3.0, 2.0, 2.0, yaw=NORTH), from_the_side)._dots).all()  # fmt: skip


def test_the_longer_the_stay_the_longer_the_arc():
    dots = [
        np.count_nonzero(drawn(to(3.0, 2.0, 2.0, hold_s=4.0, held_s=held))._dots) for held in (0.0, 1.0, 4.0)
    ]
    assert dots[0] < dots[1] < dots[2]


@pytest.mark.parametrize(
    ("at", "arrow"), [((50.0, 0.0), "→"), ((-50.0, 0.0), "←"), ((0.0, 50.0), "↑"), ((0.0, -50.0), "↓")]
)
def test_a_goal_beyond_the_edge_has_an_arrow_there(at, arrow):
    assert f"2/5 4 m {arrow}" in text(drawn(to(*at, 2.0))) or f"{arrow} 2/5 4 m" in text(drawn(to(*at, 2.0)))


@given(st.tuples(*[st.floats(-1e4, 1e4)] * 3), st.integers(30, 200), st.integers(20, 120))
def test_a_goal_anywhere_is_drawn_on_every_map(at, width, height):
    view = View(0.0, 0.0, 0.1, 2 * (width // 2), 4 * (height // 4))
    canvas = Canvas(view.width // 2, view.height // 4)
    goals.draw_goal(canvas, view, to(*at), math.dist(at, (0, 0, 2)))
    assert text(canvas).strip()


GATES = Gate("a", (3.0, 1.8, 2.0), 2.0, 2.0, yaw_deg=180.0), Gate("b", (9.0, 0.0, 2.0), 2.0, 2.0)
ARCH = with_(RUN.mission, obstacle=GATES)


def ways(guide: Guide) -> Canvas:
    canvas = Canvas(80, 25)
    goals.draw_ways(canvas, View(6.0, 0.0, 0.1, 160, 100), ARCH, guide)
    return canvas


def test_what_is_behind_is_dim_and_the_gate_that_is_next_bright():
    none, some = (
        ways(Guide(points=5, gate="a")),
        ways(Guide(points=5, reached=3, gate="b", passed=frozenset("a"))),
    )
    assert count(none, Tone.FAINT) == 0
    assert count(some, Tone.FAINT) > 5
    assert count(some, Tone.ROUTE) < count(none, Tone.ROUTE)
    done = ways(Guide(points=5, reached=5, passed=frozenset("ab")))
    assert count(done, Tone.TARGET) == 0


def test_a_gates_arrow_goes_the_way_of_the_route():
    # The gate itself looks west; the route leads through it to the east.
    assert goals._backward(ARCH, ARCH.obstacle[0])
    assert not goals._backward(ARCH, ARCH.obstacle[1])


def inside(shown: Frame, *, chase: bool) -> str:
    canvas = Canvas(80, 24)
    eye = camera(shown, 80, 24, 1.0, chase=chase)
    assert eye is not None
    draw_inside(canvas, shown, eye, solids(shown.run.mission), Fence(), chase=chase)
    return text(canvas)


@pytest.mark.parametrize("chase", [True, False])
def test_from_within_the_goal_has_its_number_and_distance_or_an_arrow_to_it(chase):
    assert "2/5 5.0 m" in inside(frame(to(5.0, 0.0, 2.0)), chase=chase)
    assert "← 2/5 5.0 m" in inside(frame(to(-4.0, 3.0, 2.0)), chase=chase)
    assert "2/5 5.0 m →" in inside(frame(to(-4.0, -3.0, 2.0)), chase=chase)


def test_without_who_follows_the_mission_its_target_is_marked():
    assert goals_inside.aim(RUN.mission, Guide()).at == RUN.mission.target.position
    assert goals_inside.aim(RUN.mission, Guide(points=5, reached=5)) is None
    assert "target" in inside(frame(None), chase=False)


GHOSTLY = with_(RUN, ghost=Track(0.5, tuple((0.2 * step, 1.0, 2.0) for step in range(60))))


def test_a_ghost_is_on_the_map_and_within_and_moves_with_the_flight():
    seen = []
    for elapsed in (2.0, 6.0):
        canvas = Canvas(80, 25)
        draw_ghost(canvas, VIEW, frame(to(5.0, 0.0, 2.0, elapsed=elapsed), run=GHOSTLY), named=True)
        assert "ghost" in text(canvas)
        _, columns = np.nonzero(canvas._dots)
        seen.append(columns.max())
        lines = ghost_lines(frame(to(5.0, 0.0, 2.0, elapsed=elapsed), run=GHOSTLY))
        assert lines[1].segments[..., 0].mean() == pytest.approx(0.4 * elapsed, abs=0.05)
    assert seen[1] - seen[0] == pytest.approx(1.6 / VIEW.scale, abs=2)


def test_before_take_off_and_without_one_there_is_no_ghost():
    for shown in (frame(to(5.0, 0.0, 2.0, elapsed=0.0), run=GHOSTLY), frame(to(5.0, 0.0, 2.0)), frame(None)):
        canvas = Canvas(80, 25)
        draw_ghost(canvas, VIEW, shown, named=True)
        assert not text(canvas).strip()
        assert ghost_lines(shown) == []


def test_a_place_that_is_not_known_has_no_way():
    assert way_of(frame(to(5.0, 0.0, 2.0), (math.nan,) * 4)) is None
    guide = to(5.0, 0.0, 2.0)
    assert whereabouts(guide, way_to(guide.goal, (0.0, 0.0, 2.0, 0.0))) == "5.0 m, ahead"


async def test_the_smallest_screen_is_enough_to_fly_by():
    async with cockpit(14.5) as scene:
        shown = frame(to(5.0, 3.0, 2.0, say="Past the crate."))
        scene.app._flight._map.show(shown)
        scene.app._flight._map._paint(shown)
        assert "2/5 Past the crate." in scene.text("#map")
