"""Courses out of a seed: whatever kind, seed, level and airframe, they can be flown; a seed is a course."""

from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.config import Settings
from groundstation.training.checking import clearance, faults
from groundstation.training.courses import GRADES, KINDS, course, time_for
from sim.airframe import load_airframe

seeds, levels = st.integers(0, 2**31), st.sampled_from(sorted(GRADES))
airframes = st.sampled_from(["crazyflie", "hummingbird", "x500", "matrice_100"])


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(KINDS), seeds, levels, airframes)
def test_every_course_can_be_flown(kind, seed, level, name):
    mission, airframe = course(kind, seed, level, name), load_airframe(name)
    assert faults(mission, airframe) == []
    # More than the guard's margin is left, or the guard would brake on the very way.
    needed = airframe.radius + Settings().shield.margin
    assert needed + 0.7 * GRADES[level].spare < clearance(mission)
    assert mission.criteria.time_limit_s == time_for(mission)


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(KINDS), seeds, levels)
def test_the_same_seed_is_the_same_course_and_another_is_another(kind, seed, level):
    assert course(kind, seed, level) == course(kind, seed, level)
    assert course(kind, seed, level).obstacle != course(kind, seed + 1, level).obstacle


@given(st.sampled_from(KINDS), seeds)
def test_a_higher_level_leaves_less_room_and_stands_fuller(kind, seed):
    easy, hard = course(kind, seed, 1), course(kind, seed, 5)
    assert clearance(hard) < clearance(easy)
    assert len(hard.obstacle) >= len(easy.obstacle)
    assert easy.wind.mean == (0.0, 0.0, 0.0) != hard.wind.mean
