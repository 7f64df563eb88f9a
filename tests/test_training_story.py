"""Where points were lost: every point that a score lacks is told, at the moment that cost it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_training_measurer import MISSION, STEP, flown

from groundstation.training.attempts import Attempts
from groundstation.training.events import GustNow, WindChange
from groundstation.training.happening import Calm
from groundstation.training.judgement import judgement_of
from groundstation.training.measurer import HandSight, Measurer, VehicleSight
from groundstation.training.measures import Measures
from groundstation.training.score import UNFINISHED
from groundstation.training.story import Moment, clock, worth_telling
from groundstation.training.telling import Landings, told

PAR = Measures(time_s=10.0, reached=1.0, rms_error_m=0.1, path_error_m=0.02, effort_n=0.5, smoothness=-1.5)


def by_part(judgement) -> dict[str, Moment]:
    return {moment.part: moment for moment in judgement.story}


@settings(max_examples=15, deadline=None)
@given(st.floats(0.0, 1.6), st.floats(0.0, 9.0), st.floats(0.0, 2.0), st.floats(0.0, 1.0))
def test_every_point_that_is_lost_is_told(y, force, error, changed):
    judgement = judgement_of(flown(y, force, error, changed), PAR)
    lost = math.fsum(moment.lost for moment in judgement.story)
    assert lost == pytest.approx(100.0 - judgement.score.points)
    costs = [moment.lost for moment in judgement.story]
    assert costs == sorted(costs, reverse=True)


def test_a_moment_has_its_time_and_place():
    measurer = flown(y=0.9, force=3.0, error=0.4, changed=0.2)
    story = by_part(judgement_of(measurer, PAR))
    near = story["clearance"]
    # The sphere stands beside x = 4 m, which is passed 4 s after the climb of 101 steps.
    assert near.place[0] == pytest.approx(4.0, abs=0.05)
    assert near.t == pytest.approx(STEP * 301, abs=0.1)
    assert near.words == "0.10 m from 'pillar'"
    assert story["time"].t == pytest.approx(measurer.took_off_t + 10.0)
    assert story["landing"].t == measurer.end_t
    assert "landed" in story["landing"].words
    assert "0.40 m behind the hand" in story["following"].words
    guarded = story["agreement"]
    assert guarded.until - guarded.t == pytest.approx(STEP * 530, abs=0.2)
    assert story["effort"].words == "the hand held against 3.0 N"


def test_the_hold_is_told_when_it_ended():
    measurer = flown(y=0.2)
    precision = by_part(judgement_of(measurer, PAR))["precision"]
    assert precision.t == measurer.held_t == pytest.approx(STEP * (101 + 400 + 10), abs=0.5)
    assert precision.words.startswith("held 0.")


def test_each_collision_costs_its_share():
    measurer = flown(y=1.1)
    judgement = judgement_of(measurer, PAR)
    touched = [moment for moment in judgement.story if moment.part == "clearance"]
    assert [moment.words for moment in touched] == ["touched 'pillar'"]
    weight = next(part.weight for part in judgement.score.parts if part.name == "clearance")
    assert touched[0].lost == pytest.approx(weight)
    assert not judgement.passed


def test_a_hand_on_the_leash_is_said_to_be():
    measurer = Measurer(MISSION, 0.2)
    for row in range(300):
        t = STEP * row
        measurer.vehicle(VehicleSight(t, (0.0, 0.0, min(2.0, t), 0.0), (0.0, 0.0, 1.0), True, True))
        measurer.hand(HandSight(t, True, (1.5, 0.0, 0.0), 0.0, (0.0, 0.0, 1.0), on_leash=True))
    judgement = judgement_of(measurer, PAR)
    assert by_part(judgement)["following"].words.endswith("on the leash")


def test_what_was_not_flown_is_told_at_the_end():
    measurer = Measurer(MISSION, 0.2)
    for row in range(200):
        t = STEP * row
        measurer.vehicle(VehicleSight(t, (0.0, 0.0, min(2.0, t), 0.0), (0.0, 0.0, 0.0), True, True))
    judgement = judgement_of(measurer, PAR)
    story = by_part(judgement)
    assert judgement.score.points == 0.0
    assert story[UNFINISHED].words == "0% of the mission's points were reached"
    assert story["precision"].words == "the target was not held"
    assert story["landing"].words == "it did not land"
    assert story["effort"].words == "the hand was never coupled"
    assert math.fsum(moment.lost for moment in judgement.story) == pytest.approx(100.0)


def test_landed_and_up_again_is_another_attempt():
    attempts = Attempts(MISSION, 0.2)

    def fly(start: float, height: float) -> None:
        for row in range(100):
            attempts.show(
                VehicleSight(start + row * STEP, (0.0, 0.0, height, 0.0), (0.0, 0.0, 0.0), True, True)
            )
        attempts.show(VehicleSight(start + 2.1, (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), False, False))

    attempts.show(HandSight(0.0, True, (0.1, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0)))
    fly(0.0, 1.0)
    first = attempts.judged
    fly(10.0, 2.0)
    assert attempts.landed == [first, attempts.current]
    assert attempts.judged is attempts.current is not first
    # The hand that was coupled before still is.
    assert attempts.current.vehicle_rows[0].t >= 10.0
    assert attempts.current.measures().time_s == pytest.approx(2.1)
    attempts.show(VehicleSight(20.0, (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0), True, True))
    assert attempts.judged is attempts.landed[-1] is not attempts.current


def test_it_is_told_in_lines():
    judgement = judgement_of(flown(y=0.9), PAR)
    lines = list(told(judgement, "the expert operator on seed 3", start=-5.0))
    assert lines[0].startswith("score")
    assert lines[0].endswith("of 100, held against the expert operator on seed 3")
    assert sum(line.startswith("  ") and " of " in line for line in lines) >= len(judgement.score.parts)
    first = judgement.story[0]
    assert f"(--at {first.t + 5.0:.1f}), {first.part}: {first.words}" in "\n".join(lines)
    assert "nobody has flown" in next(iter(told(judgement, "")))


def test_a_landing_is_told_once():
    landings = Landings("the expert operator on seed 3")
    first, second = judgement_of(flown(y=1.1), PAR), judgement_of(flown(), None)
    assert list(landings.news(None)) == []
    lines = list(landings.news(first))
    assert lines[0].startswith("Landed, NOT passed: ")
    assert "1 collisions, 0 forgiven" in lines[0]
    assert lines[1:] == list(told(first, "the expert operator on seed 3"))
    assert list(landings.news(first)) == []
    assert next(landings.news(second)).startswith("Landed, NOT" if second.shortcomings else "Passed.")


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.0, "0:00.0"), (67.25, "1:07.2"), (59.96, "1:00.0"), (math.nan, "–"), (-1.0, "0:00.0")],
)
def test_a_clock(seconds, words):
    assert clock(seconds) == words


def test_trifles_are_not_told():
    moments = [Moment("time", 0.0, 0.0, lost, "", (0.0, 0.0, 0.0)) for lost in (3.0, 0.4)]
    assert worth_telling(moments) == moments[:1]


def test_a_flight_that_an_instructor_had_a_hand_in_is_marked_and_the_next_as_far_as_it_lasts():
    attempts = Attempts(MISSION, 0.2)

    def fly(start: float) -> bool:
        for row in range(100):
            position, still = (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
            attempts.show(VehicleSight(start + row * STEP, position, still, True, True))
        attempts.show(VehicleSight(start + 2.1, (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), False, False))
        return attempts.judged.instructed

    assert not fly(0.0)
    attempts.instruct(10.5, GustNow(velocity=(4.0, 0.0, 0.0), duration_s=2.0))
    assert fly(10.0)
    # A gust on the ground has passed by the next take-off; a wind has not, until it is taken back.
    attempts.instruct(15.0, GustNow(velocity=(4.0, 0.0, 0.0), duration_s=2.0))
    assert not fly(20.0)
    attempts.instruct(25.0, WindChange(velocity=(4.0, 0.0, 0.0)))
    assert fly(30.0)
    assert fly(40.0)
    attempts.instruct(45.0, Calm())
    assert not fly(50.0)
