"""Scores: within bounds, part by part, better when the flight is better."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.director import Figures
from groundstation.training.mission import MISSIONS_FOLDER, Criteria, Mission, Target, load_mission
from groundstation.training.score import score_of

PAPER = load_mission(MISSIONS_FOLDER / "paper.toml")
FREE = Mission(schema=1, name="m", title="t")
NUMBERS = st.floats(0.0, 1e3) | st.just(math.nan) | st.just(math.inf)


def figures(**changes) -> Figures:
    values = {
        "error_squares": 0.05,
        "error_count": 10,
        "final_error": 0.05,
        "duration": 40.0,
        "least_clearance": 0.6,
    }
    return Figures(**(values | changes))


def parts(mission, flown):
    score = score_of(mission, flown)
    assert score is not None
    return {part.name: part.share for part in score.parts}


def test_the_parts_follow_their_formulas():
    assert parts(PAPER, figures()) == {
        "precision": pytest.approx(0.75),
        "time": 1.0,
        "following": pytest.approx(1.0 - math.sqrt(0.005)),
        "clearance": 1.0,
    }
    late = parts(PAPER, figures(duration=67.5, least_clearance=0.2))
    assert late["time"] == pytest.approx(0.5)
    assert late["clearance"] == pytest.approx(0.4)


def test_a_collision_takes_the_clearance_and_a_target_not_held_two_parts():
    flown = parts(PAPER, figures(collisions=1, final_error=math.nan))
    assert (flown["clearance"], flown["precision"], flown["time"]) == (0.0, 0.0, 0.0)


def test_what_a_mission_does_not_ask_for_is_no_part():
    open_field = Mission(schema=1, name="m", title="t", target=Target((1.0, 0.0, 2.0)), criteria=Criteria())
    assert set(parts(open_field, figures())) == {"precision", "time", "following"}
    assert score_of(FREE, figures()) is None


def test_gates_count_by_their_share():
    assert parts(PAPER, figures(gates=4, gates_missed=1))["gates"] == 0.75


@given(NUMBERS, NUMBERS, st.floats(-5.0, 50.0) | st.just(math.inf), st.integers(0, 9), st.integers(0, 99))
def test_every_flight_gets_a_score_within_bounds(final, duration, clearance, collisions, count):
    flown = figures(
        final_error=final,
        duration=duration,
        least_clearance=clearance,
        collisions=collisions,
        error_count=count,
    )
    score = score_of(PAPER, flown)
    assert score is not None
    assert 0.0 <= score.points <= 100.0
    assert all(0.0 <= part.share <= 1.0 for part in score.parts)
