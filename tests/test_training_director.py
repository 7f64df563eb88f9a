"""A mission is followed and judged: stages, contacts, the hold, the verdict."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.director import Director, Stage
from groundstation.training.mission import Criteria, Landing, Mission, Target, Waypoint
from sim.environment.world import World
from sim.scenario import Gate, Pad, Sphere

BALL = Sphere(name="ball", center=(5.0, 0.0, 2.0), radius=1.0)


def director(route=((3.0, 3.0, 2.0),), hold_s=1.0, obstacles=(BALL,), **criteria) -> Director:
    mission = Mission(
        schema=1,
        name="m",
        title="t",
        route=route,
        target=Target(position=(10.0, 0.0, 2.0), radius=0.3, hold_s=hold_s),
        criteria=Criteria(**criteria),
        obstacle=obstacles,
    )
    return Director(mission, World(obstacles), radius=0.3)


def fly(it: Director, points, dt=0.1, t=0.0, in_air=True, armed=True) -> float:
    for point in points:
        it.vehicle(t, (*point, 0.0), in_air=in_air, armed=armed)
        t += dt
    return t


def test_nothing_counts_before_take_off():
    it = director()
    fly(it, [(0.0, 0.0, 0.0)] * 10, in_air=False)
    assert it.stage is Stage.WAITING
    assert it.figures.duration == 0.0


def test_a_flight_that_does_all_succeeds():
    it = director()
    t = fly(it, [(0.0, 0.0, 1.0), (0.0, 0.0, 1.9)])
    assert it.stage is Stage.ROUTE
    t = fly(it, [(3.0, 3.0, 2.0), (7.0, 3.0, 2.0)], t=t)
    assert it.leg == 1
    t = fly(it, [(10.0, 0.1, 2.0)] * 15, t=t)
    assert it.stage is Stage.RETURNING
    assert it.figures.final_error == pytest.approx(0.1)
    fly(it, [(10.0, 0.1, 0.0)], t=t, in_air=False, armed=False)
    assert it.stage is Stage.DONE
    assert it.shortcomings() == []
    assert it.figures.path == pytest.approx(
        0.9 + math.dist((0, 0, 1.9), (3, 3, 2)) + 4 + math.dist((7, 3, 2), (10, 0.1, 2)) + 2.0
    )
    assert it.figures.duration == pytest.approx(t)


def test_leaving_the_target_begins_the_hold_anew():
    it = director()
    t = fly(it, [(0.0, 0.0, 2.0), (3.0, 3.0, 2.0), (3.0, 3.0, 2.0)])
    t = fly(it, [(10.0, 0.0, 2.0)] * 8, t=t)
    assert it.stage is Stage.HOLDING
    t = fly(it, [(10.0, 0.5, 2.0)], t=t)
    assert it.stage is Stage.ROUTE
    fly(it, [(10.0, 0.0, 2.0)] * 8, t=t)
    assert it.stage is Stage.HOLDING


def test_a_contact_counts_once_while_it_lasts():
    it = director()
    t = fly(it, [(0.0, 0.0, 2.0)])
    t = fly(it, [(3.7, 0.0, 2.0)] * 5, t=t)
    assert it.figures.collisions == 1
    t = fly(it, [(3.0, 0.0, 2.0)], t=t)
    assert it.clearance == pytest.approx(0.7)
    fly(it, [(3.7, 0.0, 2.0)], t=t)
    assert it.figures.collisions == 2
    assert any("2 collisions" in words for words in it.shortcomings())


def test_shortcomings_say_what_is_missing():
    it = director(time_limit_s=0.5)
    t = fly(it, [(0.0, 0.0, 2.0)] * 10)
    fly(it, [(0.0, 0.0, 0.0)], t=t, armed=False, in_air=False)
    words = "; ".join(it.shortcomings())
    assert "target was not reached" in words
    assert "is over 0 s" in words


def test_error_and_force_are_summed_up():
    it = director()
    it.controller((0.3, 0.0, 0.4), (1.0, 2.0, 2.0))
    it.controller((0.0, 0.0, 0.0), (0.5, 0.0, 0.0))
    assert it.figures.rms_error == pytest.approx(math.sqrt(0.25 / 2))
    assert it.figures.max_force == pytest.approx(3.0)


def test_the_record_says_where_the_mission_is():
    it = director()
    fly(it, [(0.0, 0.0, 2.0), (4.0, 0.0, 5.0)])
    record = it.progress(1.5)
    assert record.stage == b"on the way"
    assert (record.leg, record.legs) == (0, 2)
    assert record.target_distance == pytest.approx(math.dist((4, 0, 5), (10, 0, 2)))


points = st.tuples(*[st.floats(-20, 20)] * 3)


@given(st.lists(st.tuples(points, st.booleans(), st.booleans()), max_size=40))
def test_any_flight_is_followed(path):
    it = director()
    for number, (point, in_air, armed) in enumerate(path):
        it.vehicle(number * 0.1, (*point, 0.0), in_air=in_air, armed=armed)
    assert it.figures.path >= 0
    assert it.shortcomings() or it.stage is Stage.DONE
    assert 0 <= it.leg <= it.legs


def test_every_gate_is_to_be_flown_through():
    gates = tuple(Gate(name, (x, 0.0, 2.0), 2.0, 2.0) for name, x in (("first", 2.0), ("second", 6.0)))
    it = director(obstacles=gates)
    fly(it, [(0.0, 0.0, 2.0), (4.0, 0.0, 2.0), (4.0, 3.0, 2.0), (8.0, 3.0, 2.0)])
    words = "; ".join(it.shortcomings())
    assert "gate 'second' was not flown through" in words
    assert "first" not in words


def test_trembling_at_an_obstacle_is_one_contact():
    it = director()
    t = fly(it, [(0.0, 0.0, 2.0)])
    fly(it, [(3.7, 0.0, 2.0), (3.65, 0.0, 2.0)] * 5, t=t)
    assert it.figures.collisions == 1


def test_a_flight_without_a_target_is_free_once_its_route_is_flown():
    mission = Mission(schema=1, name="m", title="t", route=((3.0, 0.0, 2.0),))
    it = Director(mission, World(()), radius=0.3)
    t = fly(it, [(0.0, 0.0, 2.0)] * 2)
    assert (it.stage, it.at_the_end) == (Stage.ROUTE, False)
    fly(it, [(3.0, 0.0, 2.0)] * 2, t=t)
    assert (it.stage, it.at_the_end) == (Stage.FREE, True)


def test_a_point_can_ask_for_a_stay_and_for_a_heading():
    mission = Mission(1, "yaw", "", route=(Waypoint((2.0, 0.0, 2.0), radius=0.5, hold_s=1.0, yaw_deg=90.0),))
    it = Director(mission, World(()), radius=0.3)
    it.vehicle(0.0, (0.0, 0.0, 2.0, 0.0), in_air=True, armed=True)
    it.vehicle(0.1, (0.0, 0.0, 2.0, 0.0), in_air=True, armed=True)
    for number in range(30):
        it.vehicle(1.0 + 0.1 * number, (2.0, 0.0, 2.0, 0.0), in_air=True, armed=True)
    assert it.leg == 0, "the nose points east"
    for number in range(12):
        it.vehicle(5.0 + 0.1 * number, (2.0, 0.0, 2.0, 1.5), in_air=True, armed=True)
        if number == 5:
            assert it.stage is Stage.STAYING
    assert it.leg == 1
    assert it.stage is Stage.FREE


@pytest.mark.parametrize(("x", "right"), [(5.2, True), (6.0, False)])
def test_a_flight_that_must_end_on_a_pad_is_judged_by_where_it_stands(x, right):
    mission = Mission(1, "pad", "", landing=Landing("north"), pad=(Pad("north", (5.0, 0.0, 0.0), 0.6),))
    it = Director(mission, World(()), radius=0.3)
    it.vehicle(0.0, (0.0, 0.0, 2.0, 0.0), in_air=True, armed=True)
    it.vehicle(0.1, (0.0, 0.0, 2.0, 0.0), in_air=True, armed=True)
    it.vehicle(0.2, (0.0, 0.0, 2.0, 0.0), in_air=True, armed=True)
    assert it.stage is Stage.LANDING
    assert it.goal is not None
    assert it.goal.at == (5.0, 0.0, 0.0)
    it.vehicle(9.0, (x, 0.0, 0.0, 0.0), in_air=False, armed=False)
    assert it.figures.landing_error == pytest.approx(x - 5.0)
    assert (not it.shortcomings()) == right
