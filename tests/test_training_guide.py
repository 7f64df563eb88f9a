"""What comes next in a mission: goal, way, stay, gates; and the ghost that is followed."""

from __future__ import annotations

import argparse
import math

import pytest
from canned_flight import canned_run
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from groundstation.fly import accompanied
from groundstation.fly_options import share
from groundstation.progress.company import SKILLED, ghost_of, guidance_of, skill_of
from groundstation.progress.flown import Flown
from groundstation.progress.opening import store_in
from groundstation.progress.store import Store
from groundstation.training.director import Director, Goal, Stage
from groundstation.training.ghost import ghost_at, ghost_trail
from groundstation.training.guide import guide_of, way_to
from groundstation.training.measures import Measures, Track
from groundstation.training.mission import Landing, Target, Waypoint, find_mission, load_mission
from groundstation.training.reference import EXPERT, Reference, digest_of, save_reference
from sim.environment.world import World
from sim.scenario import Gate, Pad

TRACK = Track(0.5, ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (2.0, 0.0, 1.0)))
MISSION = replace(
    load_mission(find_mission("hover")),
    route=(Waypoint((2.0, 0.0, 2.0), hold_s=2.0, yaw_deg=90.0, say="Look north."), (4.0, 0.0, 2.0)),
    target=Target((6.0, 0.0, 2.0), hold_s=3.0),
    obstacle=(Gate("a", (3.0, 0.0, 2.0), 2.0, 2.0), Gate("b", (5.0, 0.0, 2.0), 2.0, 2.0)),
    pad=(Pad("home", (6.0, 3.0, 0.0), 0.5),),
    landing=Landing("home"),
    takeoff_altitude_m=2.0,
)


def director() -> Director:
    return Director(MISSION, World(MISSION.obstacle), 0.2)


def flown(
    *places: tuple[float, float, float, float], armed: bool = True, every: float = 0.5
) -> tuple[Director, float]:
    """Return the director after the vehicle was at places, `every` s apart."""
    found, t = director(), 100.0
    for place in places:
        found.vehicle(t, place, in_air=True, armed=armed)
        t += every
    return found, t - every


NORTH = math.pi / 2
UP = (0.0, 0.0, 2.0, 0.0)


def test_on_the_ground_the_first_point_is_next():
    guide = guide_of(director(), 100.0)
    assert guide.goal == Goal((2.0, 0.0, 2.0), 1.0, NORTH, "Look north.")
    assert (guide.number, guide.hold_s, guide.held_s, guide.elapsed) == ("1/4", 2.0, 0.0, 0.0)
    assert (guide.gate, guide.passed) == ("a", frozenset())


def test_the_stay_counts_only_where_the_nose_points_as_asked():
    found, t = flown(UP, (2.0, 0.0, 2.0, 0.0), (2.0, 0.0, 2.0, 0.0))
    assert guide_of(found, t).held_s == 0.0
    found, t = flown(UP, UP, *[(2.0, 0.0, 2.0, NORTH)] * 3)
    guide = guide_of(found, t)
    assert guide.held_s == pytest.approx(1.0)
    assert guide.elapsed == pytest.approx(2.0)


def test_points_behind_and_gates_passed_are_told_and_the_pad_is_the_last_goal():
    stay = [(2.0, 0.0, 2.0, NORTH)] * 6
    found, t = flown(UP, UP, *stay, (4.0, 0.0, 2.0, 0.0), (4.0, 0.0, 2.0, 0.0))
    guide = guide_of(found, t)
    assert (guide.number, guide.gate, guide.passed) == ("3/4", "b", {"a"})
    found, t = flown(UP, UP, *stay, (4.0, 0.0, 2.0, 0.0), *[(6.0, 0.0, 2.0, 0.0)] * 8)
    guide = guide_of(found, t)
    assert (guide.number, guide.landing, guide.gate) == ("4/4", True, "")
    assert guide.goal.at == (6.0, 3.0, 0.0)
    found.vehicle(t + 1.0, (6.0, 3.0, 0.0, 0.0), in_air=False, armed=False)
    assert found.stage is Stage.DONE
    assert guide_of(found, t + 1.0).goal is None


@given(
    st.tuples(*[st.floats(-50, 50)] * 3), st.tuples(*[st.floats(-50, 50)] * 3), st.floats(-math.pi, math.pi)
)
def test_the_way_is_the_same_from_wherever_it_is_looked_at(goal, place, yaw):
    way = way_to(Goal(goal, 0.5), (*place, yaw))
    assert way.distance == pytest.approx(math.dist(goal, place), abs=1e-9)
    c, s = math.cos(yaw), math.sin(yaw)
    there = (c * way.ahead - s * way.left, s * way.ahead + c * way.left, way.up)
    assert there == pytest.approx(tuple(a - b for a, b in zip(goal, place, strict=True)), abs=1e-6)


def test_bearing_and_turn_are_counter_clockwise_and_left_out_where_they_mean_nothing():
    way = way_to(Goal((0.0, 5.0, 2.0), 0.5, math.pi), (0.0, 0.0, 2.0, 0.0))
    assert way.bearing == pytest.approx(NORTH)
    assert abs(way.turn) == pytest.approx(math.pi)
    above = way_to(Goal((0.0, 0.0, 9.0), 0.5, 0.05), (0.0, 0.0, 2.0, 0.0))
    assert math.isnan(above.bearing)
    assert above.turn == 0.0


def test_a_ghost_moves_straight_between_its_rows_and_stays_where_it_landed():
    assert ghost_at(TRACK, 0.0) is None
    assert ghost_at(TRACK, 0.25) == pytest.approx((0.0, 0.0, 0.5))
    assert ghost_at(TRACK, 1.25) == pytest.approx((1.5, 0.0, 1.0))
    assert ghost_at(TRACK, 99.0) == (2.0, 0.0, 1.0)
    assert ghost_at(Track(0.5), 1.0) is None
    assert ghost_trail(TRACK, 0.0, 5.0) == []


@given(st.floats(0.001, 20.0), st.floats(0.1, 10.0))
def test_a_ghosts_trail_leads_to_it_and_is_never_longer_than_its_seconds(elapsed, seconds):
    trail = ghost_trail(TRACK, elapsed, seconds)
    assert trail[-1] == ghost_at(TRACK, elapsed)
    assert len(trail) - 1 <= seconds / TRACK.every_s + 1


def test_whose_ghost_it_is(tmp_path):
    mission = load_mission(find_mission("hover"))
    path = tmp_path / "hover.toml"
    best = replace(TRACK, every_s=0.1)
    assert ghost_of("", mission, path, None) is None
    assert ghost_of("", mission, path, best) is best
    save_reference(Reference(digest_of(mission), {EXPERT: {0: Measures()}}, {EXPERT: TRACK}), path)
    assert ghost_of("", mission, path, None) == TRACK
    assert ghost_of("reference", mission, path, best) == TRACK
    assert ghost_of("best", mission, path, None) is None
    assert ghost_of("off", mission, path, best) is None
    other = replace(mission, takeoff_altitude_m=5.0)
    assert ghost_of("reference", other, path, best) is None


def flight(points: float, number: int = 0) -> Flown:
    mission = load_mission(find_mission("hover"))
    return Flown(
        "kim",
        "hover",
        digest_of(mission),
        f"2026-11-2{number}T10:00:00.000+00:00",
        passed=True,
        points=points,
    )


def test_guidance_is_whole_at_first_and_fades_with_skill():
    mission = load_mission(find_mission("hover"))
    assert guidance_of(mission, [], []) == 1.0
    strengths = [guidance_of(mission, [flight(points)], []) for points in (0.0, 20.0, 40.0, SKILLED, 100.0)]
    assert strengths == pytest.approx([1.0, 0.75, 0.5, 0.0, 0.0])
    assert guidance_of(load_mission(find_mission("free")), [], []) == 0.0


def test_the_coach_is_told_the_pilots_skill_in_what_is_flown():
    hover, free = load_mission(find_mission("hover")), load_mission(find_mission("free"))
    assert skill_of(hover, [], []) == skill_of(free, [], []) == 0.0
    assert skill_of(hover, [flight(60.0)], []) == pytest.approx(0.6)
    # A free flight is for nothing in particular: all that was trained counts.
    assert skill_of(free, [flight(60.0)], [hover]) == pytest.approx(0.6)


def asked(tmp_path, **other) -> argparse.Namespace:
    return argparse.Namespace(
        **({"logs": tmp_path, "ghost": "", "guidance": None, "headless": False} | other)
    )


def test_a_run_is_accompanied_by_the_pilots_best_and_guided_by_what_is_learnt(tmp_path):
    mission = load_mission(find_mission("hover"))
    run = replace(canned_run(), mission=mission, mission_path=str(tmp_path / "hover.toml"), pilot="kim")
    new = accompanied(run, asked(tmp_path))
    assert (new.ghost, new.guidance) == (None, 1.0)
    assert not store_in(tmp_path).exists()
    with Store(store_in(tmp_path)) as store:
        store.add(flight(40.0), TRACK)
    known = accompanied(run, asked(tmp_path))
    assert (known.ghost, known.guidance) == (TRACK, pytest.approx(0.5))
    assert accompanied(run, asked(tmp_path, guidance=0.25)).guidance == 0.25
    assert accompanied(run, asked(tmp_path, ghost="off")).ghost is None


def test_by_itself_nothing_guides_a_real_flight_or_a_scripted_hand(tmp_path):
    mission = load_mission(find_mission("hover"))
    run = replace(canned_run(), mission=mission, mission_path=str(tmp_path / "hover.toml"))
    assert accompanied(replace(run, simulated=False), asked(tmp_path)).guidance == 0.0
    assert accompanied(run, asked(tmp_path, headless=True)).guidance == 0.0
    assert accompanied(replace(run, mission=None), asked(tmp_path)).guidance == 0.0
    strict = replace(run.settings, training=replace(run.settings.training, guidance=0.3))
    assert accompanied(replace(run, settings=strict, simulated=False), asked(tmp_path)).guidance == 0.3


def test_a_share_is_a_number_from_0_to_1():
    assert share("0.5") == 0.5
    for wrong in ("-1", "1.5", "much", "nan"):
        with pytest.raises(argparse.ArgumentTypeError, match="0 to 1"):
            share(wrong)


def test_a_store_that_is_none_is_told_and_is_no_reason_not_to_fly(tmp_path, capsys):
    store_in(tmp_path).mkdir()
    run = accompanied(replace(canned_run(), pilot="kim"), asked(tmp_path, ghost="best"))
    assert run.ghost is None
    assert "progress cannot be kept there" in capsys.readouterr().err
