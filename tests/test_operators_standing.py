"""What simulated operators score in missions, and who passes."""

import msgspec
import pytest
from operators_support import HOP, flown, hop

from bench.school import ordered, passed, stand
from groundstation.operators.exercise import NOBODY, Flown
from groundstation.operators.standing import standing_of
from groundstation.operators.table import table
from groundstation.training.measures import Measures
from groundstation.training.mission import Criteria, Target, find_mission, load_mission
from sim.people import PEOPLE

# Thirty-two flights: a busy machine takes its time.
pytestmark = pytest.mark.timeout(240)
SEEDS = 2
# A few of those that come with the program; `python -m bench school` flies them all, on more seeds.
NAMES = ("hover", "landing", "gates", "check-ride")


@pytest.fixture(scope="module")
def standings():
    found = stand([load_mission(find_mission(name)) for name in NAMES], SEEDS)
    return {standing.mission.name: standing for standing in found}


@pytest.mark.parametrize("name", NAMES)
def test_the_expert_passes_doing_nothing_fails_and_skill_counts(standings, name):
    standing = standings[name]
    assert standing.fault == ""
    assert passed(standing, "expert") == SEEDS
    assert passed(standing, NOBODY) == 0
    assert ordered(standing)


def whole(operator, seed=0, **measures):
    return Flown(operator, seed, Measures(reached=1.0, **measures))


def test_the_expert_is_the_par_on_the_same_seed():
    standing = standing_of(HOP, [flown(seed=0), flown(seed=1), flown(operator="novice", seed=1)])
    assert [each.points for each in standing.of("expert")] == [pytest.approx(100.0, abs=2.0)] * 2
    assert standing.of("novice")[0].points < 99.0
    assert list(standing.reference.flights["expert"]) == [0, 1]
    assert list(standing.reference.tracks) == ["expert"]


def test_a_mission_the_expert_fails_has_no_par():
    hurried = standing_of(
        hop(criteria=Criteria(time_limit_s=5.0)), [flown(hop(criteria=Criteria(time_limit_s=5.0)))]
    )
    assert hurried.fault.startswith("the expert fails on seed 0: ")


def test_a_mission_that_flies_itself_has_no_par():
    lazy = hop(route=(), landing=None, target=Target((0.0, 0.0, 1.2), radius=0.5, hold_s=1.0))
    assert "does nothing passes" in standing_of(lazy, [flown(lazy, NOBODY)]).fault


def test_least_points_count():
    strict = hop(criteria=Criteria(time_limit_s=60.0, min_points=95.0))
    slow = whole("novice", time_s=59.0, path_error_m=0.5, rms_error_m=0.5)
    quick = whole("expert", time_s=20.0, path_error_m=0.1, rms_error_m=0.1)
    marked = standing_of(strict, [quick, slow]).of("novice")[0]
    assert "under 95" in marked.lacks[-1]


def test_the_table_has_a_line_a_mission_and_tells_what_is_wrong():
    hurried = msgspec.structs.replace(HOP, name="hurried", criteria=Criteria(time_limit_s=5.0))
    names = (*PEOPLE, NOBODY)
    good = standing_of(HOP, [flown(operator=name) for name in names])
    bad = standing_of(hurried, [flown(hurried, name) for name in names])
    head, first, second, _, fault = table([good, bad]).splitlines()
    assert head.split() == ["mission", "novice", "average", "expert", "doing", "nothing"]
    assert first.startswith("hop      1/1")
    assert first.endswith("fails")
    assert second.startswith("hurried  0/1")
    assert fault.startswith("hurried: the expert fails")
