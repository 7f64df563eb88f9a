"""The coach: each wrong thing is known, what is flown well gets no word, and nobody is nagged."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from canned_flight import NOTHING, canned_run
from coached_flight import Coached
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training import habits
from groundstation.training.coach import AGAIN_S, LEAST_S, QUIET_S, SHOWN_S, TIMES, Coach, LiveCoach
from groundstation.training.guide import Guide, Way
from groundstation.training.habits import Habit, Seen, Watch
from groundstation.training.oscillation import Oscillation
from sim.people import PEOPLE

AWAY = Way(5.0, 5.0, 0.0, 0.0, 0.0, 0.0)
FLYING = Seen(
    t=0.0, handle=(0.5, 0.0, 0.0), yaw=0.0, force=(0.0, 0.0, 0.0), velocity=(0.8, 0.0, 0.0), clearance=math.inf,
    closing=0.0, on_leash=False, by_position=False, way=AWAY, heading=False,
)  # fmt: skip
STEP_S = 0.05


def found(seen: Seen, seconds: float) -> list[Habit]:
    """Return what is done wrong after a moment has lasted for so long."""
    watch, habits_seen = Watch(), list[Habit]()
    for step in range(round(seconds / STEP_S) + 1):
        habits_seen = watch.look(seen._replace(t=step * STEP_S))
    return habits_seen


RESTING = {"handle": (0.0, 0.0, 0.0), "velocity": (0.0, 0.0, 0.0)}
DONE = [
    (habits.RUSHING, {"clearance": 0.6, "closing": 1.2}, 0.3),
    (habits.FIGHTING, {"force": (-2.0, 0.0, 0.0), "velocity": (0.05, 0.0, 0.0)}, 1.6),
    (habits.LEASH, {"on_leash": True}, 3.1),
    (habits.EDGE, {"by_position": True, "handle": (0.98, 0.0, 0.0)}, 0.9),
    (habits.RAMMING, {"handle": (1.0, 0.0, 0.0), "clearance": 2.0}, 1.6),
    (habits.RAMMING, {"handle": (1.0, 0.0, 0.0), "way": AWAY._replace(distance=1.5)}, 1.6),
    (habits.ALTITUDE, RESTING | {"way": Way(1.2, 0.2, 0.0, 1.2, 0.0, 0.0), "yaw": 0.2}, 3.1),
    (habits.TURNING, RESTING | {"yaw": 0.8, "velocity": (0.3, 0.0, 0.0)}, 5.1),
    (habits.WAITING, RESTING, 8.1),
]
NOT_DONE = [
    (habits.RUSHING, {"clearance": 3.0, "closing": 1.2}),
    (habits.RUSHING, {"clearance": 0.3, "closing": 0.2}),
    (habits.FIGHTING, {"force": (-2.0, 0.0, 0.0)}),
    (habits.FIGHTING, {"force": (2.0, 0.0, 0.0), "velocity": (0.0, 0.0, 0.0)}),
    (habits.EDGE, {"handle": (0.98, 0.0, 0.0)}),
    (habits.RAMMING, {"handle": (1.0, 0.0, 0.0)}),
    (habits.ALTITUDE, RESTING | {"way": Way(1.2, 0.2, 0.0, 1.2, 0.0, 0.0), "handle": (0.0, 0.0, 0.5)}),
    (habits.TURNING, RESTING | {"yaw": 0.8, "heading": True}),
    (habits.TURNING, {"yaw": 0.8}),
    (habits.WAITING, RESTING | {"way": None}),
]


@pytest.mark.parametrize(("habit", "done", "seconds"), DONE)
def test_each_wrong_thing_is_known_once_it_has_lasted(habit, done, seconds):
    seen = FLYING._replace(**done)
    assert habit in found(seen, seconds)
    assert habit not in found(seen, seconds - 0.2)


@pytest.mark.parametrize(("habit", "done"), NOT_DONE)
def test_what_only_looks_like_it_is_none(habit, done):
    assert habit not in found(FLYING._replace(**done), 10.0)


def test_what_is_flown_well_is_no_habit():
    assert found(FLYING, 20.0) == []


def swinging(
    hertz: float, lag_deg: float, handle: float = 0.5, speed: float = 0.6, *, grows: float = 0.0
) -> bool:
    """Say whether a swing of so many Hz, the vehicle so much after the hand, is an oscillation within 9 s."""
    oscillation, seen = Oscillation(), False
    for step in range(450):
        t = step / 50.0
        size = math.exp(grows * t)
        phase = math.tau * hertz * t
        swung = size * handle * math.sin(phase), size * speed * math.sin(phase - math.radians(lag_deg))
        seen = oscillation.look(t, *swung) or seen
    return seen


@pytest.mark.parametrize("hertz", [0.4, 0.7, 1.0, 1.8])
def test_hand_and_vehicle_that_swing_after_one_another_are_an_oscillation(hertz):
    assert swinging(hertz, 90.0)
    assert swinging(hertz, 90.0, grows=0.2)


@pytest.mark.parametrize(
    ("hertz", "lag_deg", "handle", "speed", "grows"),
    [
        (0.1, 90.0, 0.5, 0.6, 0.0),
        (3.0, 90.0, 0.5, 0.6, 0.0),
        (0.7, 10.0, 0.5, 0.6, 0.0),
        (0.7, 90.0, 0.1, 0.6, 0.0),
        (0.7, 90.0, 0.5, 0.05, 0.0),
        (0.7, 90.0, 0.5, 0.6, -0.5),
    ],
)
def test_slow_quick_small_settling_or_without_lag_it_is_none(hertz, lag_deg, handle, speed, grows):
    assert not swinging(hertz, lag_deg, handle, speed, grows=grows)


def test_a_hint_stands_for_a_while_and_is_not_repeated_at_once():
    coach, told, shown = Coach(), [], []
    wrong = FLYING._replace(on_leash=True)
    for step in range(12000):
        hint, said = coach.look(wrong._replace(t=step * STEP_S))
        shown.append(hint)
        if said is not None:
            told.append(step * STEP_S)
    assert len(told) == TIMES
    assert told[1] - told[0] >= AGAIN_S
    assert told[2] - told[1] >= 2 * AGAIN_S
    assert sum(bool(hint) for hint in shown) * STEP_S == pytest.approx(
        TIMES * SHOWN_S, abs=TIMES * 2 * STEP_S
    )


def test_a_hint_that_is_followed_goes_once_it_can_have_been_read():
    coach, shown = Coach(), []
    for step in range(1200):
        hint, _ = coach.look(FLYING._replace(t=step * STEP_S, on_leash=step * STEP_S < 3.5))
        shown.append(hint)
    assert sum(bool(hint) for hint in shown) * STEP_S == pytest.approx(LEAST_S, abs=2 * STEP_S)


def test_only_the_most_pressing_is_said_and_then_there_is_quiet():
    coach = Coach()
    wrong = FLYING._replace(on_leash=True, clearance=0.6, closing=1.2)
    told = [
        (step * STEP_S, said)
        for step in range(400)
        if (said := coach.look(wrong._replace(t=step * STEP_S))[1]) is not None
    ]
    assert [habit for _, habit in told] == [habits.RUSHING, habits.LEASH]
    assert told[1][0] - told[0][0] >= QUIET_S


def test_under_an_alarm_it_is_silent_and_takes_back_what_stands():
    coach = Coach()
    wrong = FLYING._replace(on_leash=True)
    said = [coach.look(wrong._replace(t=step * STEP_S), quiet=True) for step in range(200)]
    assert set(said) == {("", None)}
    assert coach.look(wrong._replace(t=10.0))[1] is habits.LEASH
    assert coach.look(wrong._replace(t=10.1), quiet=True) == ("", None)


@pytest.mark.parametrize(("level", "skill", "told"), [(1, 0.0, True), (3, 0.0, False), (1, 0.9, False)])
def test_only_beginners_are_told_the_basics(level, skill, told):
    coach = Coach(level, skill)
    still = FLYING._replace(**RESTING)
    said = [coach.look(still._replace(t=step * STEP_S))[1] for step in range(300)]
    assert (habits.WAITING in said) is told


numbers = st.floats(allow_nan=True, allow_infinity=True)
vectors = st.tuples(numbers, numbers, numbers)


@given(st.lists(st.tuples(vectors, vectors, vectors, numbers, numbers), max_size=20))
def test_no_numbers_stop_it(moments):
    coach = Coach()
    for step, (handle, force, velocity, clearance, closing) in enumerate(moments):
        seen = FLYING._replace(
            t=float(step), handle=handle, force=force, velocity=velocity, clearance=clearance, closing=closing
        )
        hint, _ = coach.look(seen)
        assert isinstance(hint, str)


def test_before_anything_came_and_uncoupled_there_is_no_hint():
    told: list[str] = []
    coach = LiveCoach(canned_run(), told.append)
    assert coach.look(NOTHING, Guide(), math.inf) == ""
    assert told == []


@pytest.mark.parametrize("name", ["waypoints", "slalom"])
def test_the_expert_gets_no_hint(name):
    flown = Coached(name, PEOPLE["expert"])
    flown.fly(60.0)
    assert flown.director.leg >= 3
    assert flown.hints == []


def test_a_hand_that_corrects_too_hard_and_too_late_is_told():
    hasty = replace(
        PEOPLE["novice"], crossover=3.0, cruise=2.0, ahead=0.0, reaction=0.5, slowing=3.0, remnant=0.1
    )
    flown = Coached("hover", hasty)
    flown.fly(40.0, lambda: bool(flown.hints))
    assert flown.hints[0][1] == f"Hint: {habits.OSCILLATING.words}"


@pytest.mark.parametrize("seed", [0, 1])
def test_who_steers_badly_keeps_nearer_to_the_way_where_the_hand_is_guided(seed):
    clumsy = replace(PEOPLE["novice"], crossover=0.3, remnant=0.12, remnant_time=1.5)
    errors = []
    for guidance in (0.0, 1.0):
        flown = Coached("waypoints", clumsy, seed, guidance)
        flown.fly(60.0)
        errors.append(flown.path_error)
    assert errors[1] < 0.9 * errors[0]


def test_who_can_more_is_left_in_quiet_for_longer():
    def pause(skill: float) -> float:
        """Return how long after the first hint another habit gets one, s."""
        coach, told = Coach(skill=skill), []
        for step in range(2000):
            done = {"on_leash": True} if not told else {"clearance": 0.6, "closing": 1.2}
            _, said = coach.look(FLYING._replace(t=step * STEP_S, **done))
            if said is not None:
                told.append(step * STEP_S)
        return told[1] - told[0]

    pauses = [pause(skill) for skill in (0.0, 0.5, 1.0)]
    assert pauses == pytest.approx([QUIET_S, 2.0 * QUIET_S, 3.0 * QUIET_S], abs=2 * STEP_S)
