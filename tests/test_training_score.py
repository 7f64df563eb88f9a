"""Scores: within bounds, part by part, better when the flight is better, against the reference operator's par."""

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.measures import Measures
from groundstation.training.mission import MISSIONS_FOLDER, Criteria, Landing, Mission, Target, load_mission
from groundstation.training.par import par_in
from groundstation.training.reference import Reference
from groundstation.training.score import YARDSTICKS, Yardstick, score_of
from sim.scenario import Gate, Pad, Sphere

PAPER = load_mission(MISSIONS_FOLDER / "paper.toml")
FREE = Mission(schema=1, name="m", title="t")
FULL = Mission(
    schema=1,
    name="full",
    title="Everything",
    route=((3.0, 0.0, 2.0),),
    target=Target((6.0, 0.0, 2.0)),
    landing=Landing("pad"),
    pad=(Pad("pad", (8.0, 0.0, 0.0)),),
    obstacle=(Gate("gate", (4.0, 0.0, 2.0), 2.0, 2.0), Sphere("ball", (2.0, 3.0, 2.0), 0.5)),
    criteria=Criteria(time_limit_s=100.0, final_error_m=0.4),
)
PAR = Measures(
    time_s=40.0,
    reached=1.0,
    rms_error_m=0.4,
    path_error_m=0.2,
    final_error_m=0.1,
    landing_error_m=0.1,
    least_clearance_m=0.8,
    gates_missed=0.0,
    smoothness=-5.0,
    disagreement_mps=0.02,
    effort_n=1.0,
)
NUMBERS = st.floats(0.0, 1e3) | st.just(math.nan) | st.just(math.inf)
ANY = st.builds(
    Measures,
    time_s=NUMBERS,
    reached=st.floats(0.0, 1.0) | st.just(math.nan),
    rms_error_m=NUMBERS,
    path_error_m=NUMBERS,
    final_error_m=NUMBERS,
    landing_error_m=NUMBERS,
    least_clearance_m=st.floats(-5.0, 50.0) | st.just(math.nan) | st.just(math.inf),
    collisions=st.integers(0, 5),
    gates_missed=st.floats(0.0, 1.0) | st.just(math.nan),
    smoothness=st.floats(-200.0, -1.0) | st.just(math.nan),
    disagreement_mps=NUMBERS,
    effort_n=NUMBERS,
)
MISSIONS = st.sampled_from([PAPER, FULL])


def changed(**changes) -> Measures:
    return msgspec.structs.replace(PAR, **changes)


def shares(measures, mission=FULL, par=PAR):
    score = score_of(mission, measures, par)
    assert score is not None
    return {part.name: part.share for part in score.parts}


def test_who_flies_like_the_reference_has_all_points():
    score = score_of(FULL, PAR, PAR)
    assert score.points == pytest.approx(100.0)
    assert {part.name for part in score.parts} == {yard.part for yard in YARDSTICKS}
    assert math.fsum(part.weight for part in score.parts) == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("part", "measures", "share"),
    [
        # From the par to the mission's own limit.
        ("time", {"time_s": 70.0}, 0.5),
        ("precision", {"final_error_m": 0.25}, 0.5),
        ("landing", {"landing_error_m": 0.3}, 0.5),
        # From the par to three times it.
        ("following", {"rms_error_m": 0.8}, 0.5),
        ("effort", {"effort_n": 2.0}, 0.5),
        ("smoothness", {"smoothness": -10.0}, 0.5),
        ("path", {"path_error_m": 0.4}, 0.5),
        # A par of nearly nothing is no trap.
        ("agreement", {"disagreement_mps": 0.07}, 0.5),
        # Nobody gains by a detour.
        ("clearance", {"least_clearance_m": 0.25}, 0.5),
        ("clearance", {"least_clearance_m": 0.5}, 1.0),
        ("clearance", {"collisions": 1}, 0.0),
        ("gates", {"gates_missed": 0.25}, 0.75),
    ],
)
def test_a_part_follows_its_formula(part, measures, share):
    found = shares(changed(**measures))
    assert found.pop(part) == pytest.approx(share)
    assert all(other == pytest.approx(1.0) for other in found.values())


def test_without_a_reference_what_is_usual_is_good():
    found = shares(changed(time_s=75.0, rms_error_m=0.45, final_error_m=0.2), par=None)
    assert found["time"] == pytest.approx(0.5)
    assert found["following"] == pytest.approx(0.75)
    assert found["precision"] == pytest.approx(0.5)
    assert all(math.isnan(part.par) for part in score_of(FULL, PAR, None).parts)


def test_who_does_nothing_gains_nothing():
    nothing = Measures(time_s=5.0, reached=0.0, rms_error_m=0.0, path_error_m=0.0, least_clearance_m=2.0,
                       gates_missed=1.0, smoothness=-1.4, disagreement_mps=0.0, effort_n=0.0)  # fmt: skip
    assert score_of(FULL, nothing, PAR).points == 0.0


def test_half_the_way_counts_half():
    found = shares(changed(reached=0.5))
    assert found["time"] == found["clearance"] == found["effort"] == pytest.approx(0.5)
    assert found["gates"] == found["landing"] == 1.0


def test_what_a_mission_does_not_ask_for_is_no_part():
    open_field = Mission(schema=1, name="m", title="t", target=Target((1.0, 0.0, 2.0)))
    assert set(shares(PAR, open_field)) == {"precision", "time", "following", "smoothness", "effort"}
    assert score_of(FREE, PAR, PAR) is None


def test_the_formula_says_both_ends_in_words():
    parts = {part.name: part.formula for part in score_of(FULL, changed(reached=0.5), PAR).parts}
    assert parts["time"] == "all at 40 s or less, none at 100 s; times 50% of the way"
    assert parts["clearance"].startswith("all at 0.5 m or more, none at 0 m or with a collision")
    assert parts["gates"] == "all at 0% missed, none at 100% missed"


@given(MISSIONS, ANY, ANY | st.none())
def test_every_flight_gets_a_score_within_bounds(mission, measures, par):
    score = score_of(mission, measures, par)
    assert 0.0 <= score.points <= 100.0
    for part in score.parts:
        assert 0.0 <= part.share <= part.quality <= 1.0
        assert 0.0 <= part.points <= part.weight <= 100.0
        assert math.isfinite(part.good + part.poor)


@given(
    MISSIONS,
    ANY,
    ANY | st.none(),
    st.sampled_from(YARDSTICKS),
    st.floats(0.0, 1e3),
)
def test_a_better_measure_never_costs_points(mission, measures, par, yard: Yardstick, other):
    value = -other if yard.measure == "smoothness" else min(other, 1.0) if yard.part == "gates" else other
    changed = msgspec.structs.replace(measures, **{yard.measure: value})
    before, after = (score_of(mission, each, par).points for each in (measures, changed))
    known = float(getattr(measures, yard.measure))
    better = math.isnan(known) or (value >= known if yard.rises else value <= known)
    assert after >= before - 1e-9 if better else after <= before + 1e-9


@given(MISSIONS, ANY, ANY | st.none(), st.floats(0.0, 1.0), st.integers(0, 5))
def test_more_of_the_way_and_fewer_collisions_never_cost_points(mission, measures, par, reached, collisions):
    further = msgspec.structs.replace(
        measures,
        reached=max(reached, 0.0 if math.isnan(measures.reached) else measures.reached),
        collisions=min(collisions, measures.collisions),
    )
    assert score_of(mission, further, par).points >= score_of(mission, measures, par).points - 1e-9


@given(ANY)
def test_measures_survive_json(measures):
    again = msgspec.json.decode(msgspec.json.encode(measures), type=Measures)
    for name in Measures.__struct_fields__:
        value = getattr(measures, name)
        assert getattr(again, name) == value or math.isnan(value)


def test_the_par_is_that_of_the_seed_or_else_the_mean_of_the_others():
    flights = {"expert": {0: PAR, 1: changed(time_s=60.0, landing_error_m=math.nan, collisions=1)}}
    reference = Reference("", flights, {})
    assert par_in(reference, 1) == (flights["expert"][1], "the expert operator on seed 1")
    mean, words = par_in(reference, 7)
    assert (mean.time_s, mean.landing_error_m, mean.collisions) == (50.0, 0.1, 0)
    assert words == "the expert operator, mean of 2 other seeds"
    assert par_in(None, 0) == (None, "")
    assert par_in(Reference("", {}, {}), 0) == (None, "")
