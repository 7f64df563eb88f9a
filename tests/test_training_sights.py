"""Records of a bus in the order of time, however late they come, and a follower on a real bus."""

from __future__ import annotations

import random

import msgspec
import pytest
from canned_flight import STEP_S, CannedFlight, canned_run
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.bus import Bus
from groundstation.messages import (
    EVENT,
    HANDLE,
    INTERVENTION_ANSWER,
    MISSION_PROGRESS,
    PILOT_STATE,
    POINTS_LOST,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Intervention,
)
from groundstation.run_folder import new_run_id
from groundstation.training.answering import answer_to
from groundstation.training.attempts import Attempts
from groundstation.training.events import GustNow
from groundstation.training.follower import MissionFollower
from groundstation.training.happening import packed
from groundstation.training.judgement import judgement_of
from groundstation.training.measures import Measures
from groundstation.training.score import score_of
from groundstation.training.sights import Sights
from groundstation.training.telling import so_far

RUN = canned_run()
PAR = Measures(time_s=20.0, reached=1.0, rms_error_m=0.2)


def flown(seconds: float):
    """Return the canned flight's records, a tuple a step, the last of which is the landing."""
    flight, steps = CannedFlight(RUN), round(seconds / STEP_S)
    found = []
    for number in range(steps):
        flight.advance(STEP_S)
        view = flight.snapshot()
        view.status.t = view.t - 0.013
        if number > steps - 5:
            view.status.armed = view.status.in_air = 0
        found.append((view.vehicle, view.status, view.pilot, view.handle))
    return found


FLOWN = flown(20.0)


def in_order(records) -> list:
    """Return what is seen when all is there at once."""
    sights = Sights()
    return [*sights.take(*zip(*records, strict=True)), *sights.rest()]


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_whatever_is_late_the_order_is_that_of_time(seed):
    rng, sights, seen = random.Random(seed), Sights(), []
    queues = [list(column) for column in zip(*FLOWN[:400], strict=True)]
    while any(queues):
        # The link's records and the pilot's come in their own time, never half a second behind each other.
        link, pilot = rng.randint(0, 10), rng.randint(0, 10)
        ahead = len(queues[0]) - len(queues[2])
        link, pilot = (0, pilot) if ahead < -10 else (link, 0) if ahead > 10 else (link, pilot)
        counts = (link, link, pilot, pilot)
        came = [queue[:count] for queue, count in zip(queues, counts, strict=True)]
        queues = [queue[count:] for queue, count in zip(queues, counts, strict=True)]
        seen += sights.take(*came)
    seen += sights.rest()
    assert seen == in_order(FLOWN[:400])
    assert [sight.t for sight in seen] == sorted(sight.t for sight in seen)


def test_a_process_that_is_silent_is_not_waited_for():
    sights = Sights()
    states, statuses, pilots, handles = zip(*FLOWN[:200], strict=True)
    seen = list(sights.take(states, statuses, pilots[:10], handles[:10]))
    # All but the last half second of the vehicle's.
    assert len(seen) == pytest.approx(200 - 25 + 10, abs=2)


def test_an_invalid_state_is_no_sight_and_before_the_first_status_there_is_none():
    sights = Sights()
    states, statuses, pilots, handles = zip(*FLOWN[:50], strict=True)
    seen = [*sights.take(states, statuses[20:], pilots, handles), *sights.rest()]
    assert len(seen) == 50 + 30


@pytest.fixture
def bus():
    bus = Bus(new_run_id(), "test")
    yield bus
    bus.close()


def test_a_follower_sees_every_record_and_tells_where_points_were_lost(bus):
    follower = MissionFollower(RUN.mission, bus, PAR)
    told = bus.subscriber(POINTS_LOST)
    topics = (VEHICLE_STATE, VEHICLE_STATUS, PILOT_STATE, HANDLE)
    publishers = [bus.publisher(topic) for topic in topics]
    for number, records in enumerate(FLOWN):
        for publisher, record in zip(publishers, records, strict=True):
            publisher.send(record)
        if number % 40 == 0:
            # It looks twice a second only: the newest alone would not do.
            follower.look(CannedFlight(RUN).snapshot())
    follower.finish()
    attempts = Attempts(RUN.mission, follower.measurer.director.radius)
    for sight in in_order(FLOWN):
        attempts.show(sight)
    expected = judgement_of(attempts.judged, PAR)
    assert repr(follower.judgement) == repr(expected)
    assert msgspec.to_builtins(expected.measures)["time_s"] > 15.0
    assert [(each.t, each.points, each.part.decode()) for each in told.drain()] == [
        (moment.t, moment.lost, moment.part) for moment in expected.story
    ]
    assert follower.complete


def test_a_follower_tells_the_score_as_it_grows(bus):
    follower = MissionFollower(RUN.mission, bus, PAR)
    progress = bus.subscriber(MISSION_PROGRESS)
    publishers = [bus.publisher(topic) for topic in (VEHICLE_STATE, VEHICLE_STATUS, PILOT_STATE, HANDLE)]
    flight = CannedFlight(RUN)
    follower.look(flight.snapshot())
    assert progress.newest().score == b""
    for records in FLOWN[:200]:
        flight.advance(STEP_S)
        for publisher, record in zip(publishers, records, strict=True):
            publisher.send(record)
    follower.look(flight.snapshot())
    measured = score_of(RUN.mission, follower.measurer.measures(), PAR)
    assert progress.newest().score.decode() == so_far(measured)


def test_a_follower_that_is_held_up_says_that_it_missed_something(bus):
    follower = MissionFollower(RUN.mission, bus, PAR)
    told = bus.subscriber(EVENT)
    topics = (VEHICLE_STATE, VEHICLE_STATUS, PILOT_STATE, HANDLE)
    publishers = [bus.publisher(topic) for topic in topics]
    for records in FLOWN[:200]:
        for publisher, record in zip(publishers, records, strict=True):
            publisher.send(record)
    follower.look(CannedFlight(RUN).snapshot())
    assert follower.complete
    for _ in range(HANDLE.depth + 1):
        publishers[-1].send(FLOWN[200][-1])
    for _ in range(2):
        follower.look(CannedFlight(RUN).snapshot())
    assert not follower.complete
    assert ["Held up" in event.text.decode() for event in told.drain()] == [True]


@pytest.mark.parametrize(
    ("source", "refused", "marked"),
    [(b"instructor", "", True), (b"instructor", "no such thing", False), (b"mission", "", False)],
)
def test_a_follower_knows_what_an_instructor_let_happen(bus, source, refused, marked):
    follower = MissionFollower(RUN.mission, bus, PAR)
    publishers = [bus.publisher(topic) for topic in (VEHICLE_STATE, VEHICLE_STATUS, PILOT_STATE, HANDLE)]
    answers = bus.publisher(INTERVENTION_ANSWER)
    for number, records in enumerate(FLOWN):
        for publisher, record in zip(publishers, records, strict=True):
            publisher.send(record)
        if number == len(FLOWN) // 2:
            asked = Intervention(t=records[0].t, number=1, source=source)
            asked.happening = packed(GustNow(velocity=(4.0, 0.0, 0.0), duration_s=2.0))
            answers.send(answer_to(asked, refused, records[0].t))
        if number % 40 == 0:
            follower.look(CannedFlight(RUN).snapshot())
    follower.finish()
    assert follower.attempts.judged.instructed is marked
