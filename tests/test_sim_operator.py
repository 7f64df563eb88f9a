"""The simulated operator, closing the loop over simple plants in virtual time."""

from __future__ import annotations

import math
from collections import deque
from itertools import pairwise
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.operator import Operator, Person

DT = 0.02
START = (0.0, 0.0, 2.0)
AROUND = ((3.0, 1.8, 2.0), (6.0, 1.6, 2.2), (8.0, -1.2, 2.2), (10.5, -1.4, 2.0))
AROUND_TO = (12.0, 0.0, 2.0)
SQUARE = ((3.0, 0.0, 2.0), (3.0, 3.0, 2.0), (0.0, 3.0, 2.0))
CALM = (0.0, 0.0, 0.0)
WIND = (0.0, 0.4, 0.0)


class Moment(NamedTuple):
    t: float
    position: tuple[float, float, float]
    velocity: tuple[float, float, float]
    wish: tuple[float, float, float, float]
    leg: int
    arrived: bool


class Plant:
    """p_h integrates the wish; the vehicle settles at p_h + wind with a lag; the picture of it comes late.

    `pull` is the hand that yields to the force of equation (5): p_h drifts toward the vehicle at that rate.
    """

    def __init__(self, wind=CALM, delay=0.0, lag=0.5, pull=0.0, yaw=0.0):
        self.wind, self.lag, self.pull = wind, lag, pull
        self.p_h, self.position, self.velocity, self.yaw = START, START, CALM, yaw
        self.picture = deque([(START, CALM, yaw)] * (round(delay / DT) + 1), maxlen=round(delay / DT) + 1)

    def step(self, wish):
        def drift(axis):
            return wish[axis] - self.pull * (self.p_h[axis] - self.position[axis])

        self.p_h = tuple(self.p_h[axis] + drift(axis) * DT for axis in range(3))
        self.velocity = tuple(
            (self.p_h[axis] + self.wind[axis] - self.position[axis]) / self.lag for axis in range(3)
        )
        self.position = tuple(self.position[axis] + self.velocity[axis] * DT for axis in range(3))
        self.yaw += wish[3] * DT
        self.picture.append((self.position, self.velocity, self.yaw))


def fly(operator, plant, seconds):
    track = []
    for tick in range(round(seconds / DT)):
        position, velocity, yaw = plant.picture[0]
        wish = operator.decide(tick * DT, (*position, yaw), velocity)
        plant.step(wish)
        moment = Moment(tick * DT, plant.position, plant.velocity, wish, operator.leg, operator.arrived)
        track.append(moment)
    return track


def off_route(place, points):
    def off_leg(a, b):
        along = [end - start for start, end in zip(a, b, strict=True)]
        to = [here - start for start, here in zip(a, place, strict=True)]
        share = sum(map(lambda p, q: p * q, along, to)) / max(sum(p * p for p in along), 1e-12)
        share = min(max(share, 0.0), 1.0)
        return math.dist(place, [start + share * p for start, p in zip(a, along, strict=True)])

    return min(off_leg(a, b) for a, b in pairwise(points))


@pytest.mark.parametrize("delay", [0.0, 0.15, 0.3])
@pytest.mark.parametrize("wind", [CALM, WIND, (0.25, -0.3, 0.1)], ids=["calm", "cross", "skew"])
@pytest.mark.parametrize("pull", [0.0, 0.6], ids=["stiff", "yielding"])
@pytest.mark.parametrize(
    ("route", "target"),
    [(AROUND, AROUND_TO), (SQUARE, START), ((), START)],
    ids=["around", "square", "hover"],
)
def test_it_flies_the_route_and_stays_at_the_target(route, target, wind, delay, pull):
    track = fly(Operator(route, target), Plant(wind, delay, pull=pull), 45.0)
    points = (START, *route, target)
    assert max(off_route(moment.position, points) for moment in track) <= 0.5
    for corner in route:
        assert min(math.dist(moment.position, corner) for moment in track) <= (0.35 if pull else 0.3)
    arrival = next(moment.t for moment in track if moment.arrived)
    assert arrival <= 1.0 + sum(map(math.dist, points, points[1:])) / 1.2 + 2.5 * len(points)
    for moment in track:
        if moment.t >= arrival + 8.0:
            assert math.dist(moment.position, target) <= 0.1
            assert math.hypot(*moment.velocity) <= 0.15
    assert track[-1].arrived


@pytest.mark.parametrize(("delay", "lag"), [(0.5, 0.5), (0.7, 0.5), (0.3, 1.0), (0.1, 0.2)])
def test_it_also_settles_where_the_loop_is_slower_or_faster_than_usual(delay, lag):
    track = fly(Operator(AROUND, AROUND_TO), Plant(WIND, delay, lag), 60.0)
    assert max(math.dist(moment.position, AROUND_TO) for moment in track if moment.t > 40.0) <= 0.1


def test_it_does_not_oscillate_at_the_target():
    """Without noise the distance falls, passes the target at most slightly, and is still."""
    person = Person(remnant=0.0, remnant_share=0.0)
    track = fly(Operator((), (4.0, 0.0, 2.0), person), Plant(WIND, 0.3), 40.0)
    assert max(moment.position[0] for moment in track) <= 4.0 + 0.15
    late = [moment for moment in track if moment.t > 20.0]
    assert max(math.dist(moment.position, (4.0, 0.0, 2.0)) for moment in late) <= 0.01
    assert max(math.hypot(*moment.velocity) for moment in late) <= 0.01


def test_wind_that_comes_up_at_the_target_is_nulled_within_seconds():
    operator, plant = Operator((), START), Plant(delay=0.2, pull=0.6)
    fly(operator, plant, 5.0)
    plant.wind = (0.4, 0.0, 0.0)
    errors = []
    for tick in range(250, 1000):
        position, velocity, yaw = plant.picture[0]
        plant.step(operator.decide(tick * DT, (*position, yaw), velocity))
        errors.append(math.dist(plant.position, START))
    assert max(errors) > 0.2
    assert max(errors[round(6.0 / DT) :]) <= 0.1


def test_it_cruises_on_a_straight_and_slows_before_a_corner_and_the_target():
    track = fly(Operator(((10.0, 0.0, 2.0),), (10.0, 10.0, 2.0)), Plant(), 30.0)

    def speed_at(leg, distance_left, end):
        near = min(
            (moment for moment in track if moment.leg == leg),
            key=lambda m: abs(math.dist(m.position, end) - distance_left),
        )
        return math.hypot(*near.velocity)

    corner, target = (10.0, 0.0, 2.0), (10.0, 10.0, 2.0)
    assert speed_at(0, 5.0, corner) == pytest.approx(1.2, abs=0.1)
    assert speed_at(0, 0.3, corner) < 0.8
    assert speed_at(1, 5.0, target) == pytest.approx(1.2, abs=0.1)
    assert speed_at(2, 0.4, target) < 0.7


def test_a_slight_bend_is_not_slowed_for():
    bend = (5.0, 0.0, 2.0)
    track = fly(Operator((bend,), (10.0, 0.5, 2.0)), Plant(), 8.0)
    near = min(track, key=lambda m: math.dist(m.position, bend))
    assert math.hypot(*near.velocity) > 1.0


def test_it_reacts_only_after_its_reaction_time():
    person = Person(remnant=0.0, remnant_share=0.0, reaction=0.2)
    operator = Operator((), START, person)
    decisions = {}
    for tick in range(100):
        t = tick * 0.01
        place = (1.0, 0.0, 2.0, 0.0) if t >= 0.5 else (*START, 0.0)
        decisions[tick] = operator.decide(t, place, CALM)
    assert all(decisions[tick] == (0.0, 0.0, 0.0, 0.0) for tick in range(70))
    assert decisions[71][0] < -0.5


@pytest.mark.parametrize("face_along", [False, True])
def test_yaw_is_left_alone_or_follows_the_route(face_along):
    plant = Plant(delay=0.2, yaw=3.0)
    track = fly(Operator(((0.0, 8.0, 2.0),), (0.0, 8.0, 6.0), Person(face_along=face_along)), plant, 30.0)
    if face_along:
        assert max(abs(moment.wish[3]) for moment in track) <= 0.5
        assert plant.yaw == pytest.approx(math.pi / 2, abs=0.1)
        assert track[-1].wish[3] == 0.0
    else:
        assert {moment.wish[3] for moment in track} == {0.0}


def test_it_turns_the_short_way_round():
    operator = Operator((), (-10.0, -1.0, 2.0), Person(face_along=True, reaction=0.0))
    assert operator.decide(0.0, (*START, 3.0), CALM)[3] > 0.0


def test_progress_is_told_leg_by_leg():
    operator = Operator(SQUARE, START)
    assert (operator.leg, operator.legs, operator.arrived) == (0, 0, False)
    track = fly(operator, Plant(), 30.0)
    assert operator.legs == 4
    legs = [moment.leg for moment in track]
    assert legs == sorted(legs)
    assert set(legs) == {0, 1, 2, 3, 4}
    assert not any(moment.arrived for moment in track if moment.leg < 4)


def test_points_on_top_of_each_other_are_one():
    operator = Operator((START, (4.0, 0.0, 2.0), (4.0, 0.0, 2.0)), (4.0, 0.0, 2.0))
    track = fly(operator, Plant(), 15.0)
    assert operator.legs == 1
    assert track[-1].arrived


def test_the_same_seed_decides_the_same_and_another_does_not():
    tracks = [fly(Operator(SQUARE, START, seed=seed), Plant(WIND), 5.0) for seed in (1, 1, 2)]
    assert tracks[0] == tracks[1]
    assert tracks[0] != tracks[2]


def test_the_noise_does_not_depend_on_how_often_it_decides():
    def spread(dt):
        operator, ticks = Operator((), START, seed=3), range(round(400.0 / dt))
        wishes = [operator.decide(tick * dt, (*START, 0.0), CALM)[0] for tick in ticks]
        return math.sqrt(sum(wish * wish for wish in wishes) / len(wishes))

    assert spread(0.02) == pytest.approx(0.02, rel=0.15)
    assert spread(0.1) == pytest.approx(0.02, rel=0.15)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("index", range(7))
def test_it_lets_go_where_it_sees_no_number_and_goes_on_afterwards(bad, index):
    operator, plant = Operator(SQUARE, START), Plant()
    fly(operator, plant, 2.0)
    numbers = [*plant.position, plant.yaw, *plant.velocity]
    numbers[index] = bad
    position, velocity = tuple(numbers[:4]), tuple(numbers[4:])
    assert operator.decide(2.0, position, velocity) == (0.0, 0.0, 0.0, 0.0)
    after = [operator.decide(2.02 + k * DT, (*plant.position, 0.0), plant.velocity) for k in range(20)]
    assert after[0] == (0.0, 0.0, 0.0, 0.0)
    assert math.hypot(*after[-1][:3]) > 0.1


coordinates = st.tuples(*(st.floats(-1000, 1000),) * 3)


@settings(max_examples=60)
@given(
    st.lists(coordinates, max_size=4),
    coordinates,
    st.lists(st.tuples(st.floats(0, 2), st.tuples(*(st.floats(-1e6, 1e6),) * 4), coordinates), max_size=30),
    st.booleans(),
)
def test_whatever_it_sees_the_wish_is_bounded(route, target, sights, face_along):
    operator, t = Operator(route, target, Person(face_along=face_along)), 0.0
    for wait, position, velocity in sights:
        t += wait
        wish = operator.decide(t, position, velocity)
        assert math.hypot(*wish[:3]) <= 1.2 * (1 + 1e-12)
        assert abs(wish[3]) <= 0.5
        assert 0 <= operator.leg <= operator.legs
