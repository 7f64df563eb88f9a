"""One case from task to outcome: the criteria, the figures, and what a task's id depends on."""

import math

import msgspec
import pytest
from evaluation_support import CASE, STEP, task

from groundstation.config import Settings
from groundstation.evaluation.case import Result
from groundstation.evaluation.referee import disagreement
from groundstation.evaluation.trial import fly, wind_of
from groundstation.messages import Phase
from sim.people import PEOPLE, accustomed
from sim.scenario import Box, Gust, Wind


def test_a_flight_that_holds_the_target_and_lands_is_completed():
    seen = []
    found = fly(task(), (seen.append,))
    outcome = found.outcome
    assert (found.id, found.case) == (task().id, task().case)
    assert outcome.completed, outcome.reason
    assert outcome.reason == ""
    # Held for half a second at the end, after 0.8 m at no more than the cruise speed.
    assert 0.5 + 0.5 / PEOPLE["average"].cruise < outcome.time < 10.0
    assert outcome.collisions == outcome.uncoupled == 0
    assert outcome.clearance == pytest.approx(3.0 - 0.2 - 0.5 - max(s.p[0] for s in seen), abs=0.05)
    assert seen[-1].p[2] == 0.0, "it did not land"
    assert outcome.flown == pytest.approx(seen[-1].t, abs=0.05)
    assert outcome.processor > 0.0


def test_the_figures_are_those_of_the_coupled_part():
    seen = []
    outcome = fly(task(), (seen.append,)).outcome
    coupled = [sample for sample in seen if sample.phase is Phase.ENGAGED]
    errors = [sum(part**2 for part in sample.outputs.error[:3]) for sample in coupled]
    forces = [math.hypot(*sample.outputs.force) for sample in coupled]
    assert outcome.rms_error == pytest.approx(math.sqrt(sum(errors) / len(errors)))
    assert outcome.mean_force == pytest.approx(sum(forces) / len(forces))
    assert outcome.max_force >= max(forces)
    assert outcome.time == pytest.approx(coupled[-1].t - coupled[0].t, abs=0.021)
    assert outcome.disagreement == pytest.approx(
        sum(disagreement(sample.outputs) for sample in coupled) / len(coupled)
    )


def test_a_target_behind_a_wall_is_not_reached_in_time_and_the_guard_disagrees():
    wall = Box("wall", (1.6, 0.0, 2.0), (0.2, 8.0, 4.0))
    target = msgspec.structs.replace(STEP.target, position=(2.5, 0.0, 1.0))
    criteria = msgspec.structs.replace(STEP.criteria, time_limit_s=10.0)
    mission = msgspec.structs.replace(STEP, obstacle=(wall,), target=target, criteria=criteria)
    outcome = fly(task(mission)).outcome
    assert not outcome.completed
    assert outcome.time is None
    assert "not reached" in outcome.reason
    assert outcome.disagreement > 0.1
    assert outcome.collisions == 0
    assert outcome.flown == pytest.approx(10.0, abs=0.05)


def test_a_vehicle_that_cannot_take_off_is_an_outcome_too():
    empty = msgspec.structs.replace(STEP, battery=msgspec.structs.replace(STEP.battery, remaining=0.01))
    outcome = fly(task(empty)).outcome
    assert not outcome.completed
    assert "take off" in outcome.reason
    assert outcome.rms_error is None


def test_wind_is_calm_the_missions_or_a_speed_whose_direction_the_seed_chooses():
    of_mission = Wind((1.0, 0.0, 0.0), (Gust(1.0, 2.0, (0.0, 2.0, 0.0)),))

    def wind(name, **case):
        return wind_of(msgspec.structs.replace(CASE, wind=name, **case), of_mission)

    assert wind("mission") == of_mission
    assert wind("calm") == Wind()
    assert math.hypot(*wind("2.5").mean) == pytest.approx(2.5)
    assert wind("2.5").mean[2] == 0.0
    assert wind("2.5", seed=1) != wind("2.5", seed=2)
    assert wind("2.5", controller="paper", delay=0.3) == wind("2.5")


def test_an_id_is_stable_and_changes_with_whatever_changes_the_flight():
    settings = Settings(control=msgspec.structs.replace(Settings().control, damping=0.1))
    other = msgspec.structs.replace(STEP, takeoff_altitude_m=1.5)
    ids = [
        task().id,
        task(seed=1).id,
        task(delay=0.1).id,
        task(other).id,
        task(settings=settings).id,
        task(source="another file").id,
    ]
    assert len(set(ids)) == len(ids)
    assert task().id == msgspec.json.decode(msgspec.json.encode(task()), type=type(task())).id == ids[0]


def test_a_result_survives_the_log():
    found = fly(task())
    assert msgspec.json.decode(msgspec.json.encode(found), type=Result) == found


@pytest.mark.parametrize("name", PEOPLE)
def test_people_lower_their_gain_with_the_delay(name):
    person = PEOPLE[name]
    late = accustomed(person, 0.5)
    own = person.reaction + person.lag
    assert late.crossover * (own + 0.5) == pytest.approx(person.crossover * own)
    assert late.cruise < person.cruise
    assert accustomed(person, 0.0) == person


def test_people_differ_as_their_names_say():
    novice, average, expert = (PEOPLE[name] for name in ("novice", "average", "expert"))
    assert novice.reaction > average.reaction > expert.reaction
    assert novice.remnant_share > average.remnant_share > expert.remnant_share
    assert novice.cruise < average.cruise < expert.cruise
