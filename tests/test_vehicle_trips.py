"""The round trip over a simulated channel in virtual time: a rise is known soon, and one late answer is no rise."""

import math
from statistics import mean

import pytest

from groundstation.vehicle.round_trip import EVERY_S
from groundstation.vehicle.trips import Trips
from sim.channel import Channel, Conditions

STEP_S = 0.01


def way(trip, loss, jitter=0.0):
    """One of two equal ways of a round trip, s; jitter as a share of the delay."""
    return Conditions(delay=trip / 2, loss=loss, jitter=jitter * trip / 2)


def measured(before, after, seed, seconds=12.0, change_t=5.0):
    """(t, round trip as it is known) every step, with the channel changed at `change_t`."""
    up, down, trips = Channel(before, f"up {seed}"), Channel(before, f"down {seed}"), Trips()
    known = []
    for n in range(round(seconds / STEP_S)):
        t = n * STEP_S
        if n == round(change_t / STEP_S):
            up.change(after)
            down.change(after)
        for frame in up.due(t):
            down.send(t, frame)
        for frame in down.due(t):
            trips.answered(int(frame), t)
        if n % round(EVERY_S / STEP_S) == 0:
            trips.asked(n, t)
            up.send(t, str(n).encode())
        known.append((t, trips.seconds(t)))
    return known


@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_a_rise_is_known_within_a_second_and_a_half(loss):
    noticed = [
        next(t - 5.0 for t, trip in measured(way(0.05, loss), way(0.7, loss), seed) if t > 5.0 and trip > 0.6)
        for seed in range(20)
    ]
    # From the change on, the first answer that can tell takes 0.7 s.
    assert min(noticed) >= 0.69
    assert sorted(noticed)[-2] <= 1.5
    assert max(noticed) <= 2.0


def test_a_long_and_lossy_way_is_measured_right_and_steadily():
    for seed in range(5):
        conditions = way(0.7, 0.3)
        known = [trip for t, trip in measured(conditions, conditions, seed) if t > 5.0]
        assert mean(known) == pytest.approx(0.7, rel=0.03)
        assert min(known) == pytest.approx(0.7, rel=0.01)
        assert max(known) < 1.3


def test_jitter_of_half_the_delay_biases_it_little():
    conditions = way(0.3, 0.1, jitter=0.5)
    known = [trip for seed in range(4) for t, trip in measured(conditions, conditions, seed) if t > 3.0]
    assert mean(known) == pytest.approx(0.3, rel=0.12)
    assert max(known) < 0.3 * 1.5


def test_a_fall_is_believed_slowly():
    known = dict(measured(way(0.7, 0.0), way(0.05, 0.0), 1, seconds=15.0))
    assert known[5.2] > 0.6
    assert known[14.9] == pytest.approx(0.05, abs=0.015)


def test_the_trip_grows_while_nobody_answers_and_comes_back():
    up_is_dead = way(0.05, 1.0)
    trips = Trips()
    for n in range(20):
        trips.asked(n, 0.1 * n)
        trips.answered(n, 0.1 * n + 0.05)
    assert trips.seconds(2.0) == pytest.approx(0.05)
    assert trips.seconds(2.6) == pytest.approx(0.05)
    assert trips.seconds(4.0) == pytest.approx(4.0 - 1.9 - 0.8)
    trips.asked(40, 4.0)
    trips.answered(40, 4.05)
    assert trips.seconds(4.05) == pytest.approx(0.05)
    silent = measured(way(0.05, 0.0), up_is_dead, 1, seconds=9.0)
    assert silent[-1][1] > 3.0


def test_before_the_first_answer_it_is_not_known():
    trips = Trips()
    assert math.isnan(trips.seconds(100.0))
    trips.asked(1, 100.0)
    assert math.isnan(trips.seconds(109.0))


def answered(trips, *pairs):
    for number, (asked_t, trip) in enumerate(pairs):
        trips.asked(1000 * number + round(asked_t * 1e3), asked_t)
        trips.answered(1000 * number + round(asked_t * 1e3), asked_t + trip)
    return trips.seconds(pairs[-1][0])


def test_one_late_answer_is_no_rise_and_two_are():
    assert answered(Trips(), (1.0, 0.05), (1.1, 0.05), (1.2, 0.9)) == pytest.approx(0.05)
    assert answered(Trips(), (1.0, 0.05), (1.1, 0.9), (1.2, 0.8)) == pytest.approx(0.8)
    assert answered(Trips(), (1.0, 0.05), (1.1, 0.9), (1.2, 0.05), (1.3, 0.9)) == pytest.approx(0.05)


def test_an_answer_that_was_not_asked_for_or_came_already_is_none():
    trips = Trips()
    trips.asked(7, 1.0)
    trips.answered(8, 1.01)
    trips.answered(-5, 1.01)
    assert math.isnan(trips.seconds(1.02))
    trips.answered(7, 1.05)
    trips.answered(7, 9.0)
    assert trips.seconds(1.05) == pytest.approx(0.05)


def test_an_answer_from_before_its_question_is_none():
    trips = Trips()
    trips.asked(7, 1.0)
    trips.answered(7, 0.5)
    assert math.isnan(trips.seconds(1.0))


def test_questions_that_nobody_answers_are_forgotten():
    trips = Trips()
    for n in range(100_000):
        trips.asked(n, 0.1 * n)
    assert len(trips._under_way) < 110
