"""Where points were lost stands in a recording at the times of its moments, though it is known after the landing."""

from __future__ import annotations

import msgspec
import pytest
from recording_support import a_run, batch_of

from groundstation.messages import POINTS_LOST, PointsLost
from groundstation.recording import entities, lanes, schema
from groundstation.recording.session import Session
from groundstation.recording.story import SHOWN_S
from groundstation.review.flight import Flight
from groundstation.training.measures import Measures

START = 50.0


def lost(t: float, until: float, points: float, part: bytes, text: bytes = b"so") -> PointsLost:
    return PointsLost(
        t=START + t, until=START + until, points=points, position=(t, 0.0, 2.0), part=part, text=text
    )


@pytest.fixture
def flight(tmp_path):
    run = msgspec.structs.replace(
        a_run(tmp_path / "flight"), par=Measures(time_s=30.0), par_from="the expert operator on seed 0"
    )
    session = Session(run, START, lambda _severity, text: pytest.fail(text))
    told = (
        lost(9.0, 9.0, 8.0, b"clearance", b"touched 'crate'"),
        lost(3.0, 6.0, 4.0, b"following"),
        lost(4.0, 5.0, 5.0, b"effort"),
    )
    session.take(batch_of(POINTS_LOST, *told))
    session.close()
    return Flight(run.recording)


def test_they_stand_among_the_events_in_their_order(flight):
    lines = [(line.t, line.text) for line in flight.events() if line.source == "score"]
    assert lines == [
        (3.0, "−4.0 following: so"),
        (4.0, "−5.0 effort: so"),
        (9.0, "−8.0 clearance: touched 'crate'"),
    ]
    assert flight.series(schema.LOST).values.tolist() == [[4.0, 3.0], [5.0, 1.0], [8.0, 0.0]]


def test_the_lane_shows_what_cost_most_and_is_quiet_in_between(flight):
    assert flight.states(lanes.POINTS) == [
        (0.0, lanes.QUIET),
        (3.0, "following"),
        (4.0, "effort"),
        (5.0, "following"),
        (6.0, lanes.QUIET),
        (9.0, "clearance"),
        (9.0 + SHOWN_S, lanes.QUIET),
    ]


def test_they_are_points_in_the_scene(flight):
    assert entities.LOSSES in flight.entities


def test_the_par_goes_with_the_flight(flight):
    assert flight.par.time_s == 30.0
    assert flight.properties()["par_from"] == "the expert operator on seed 0"
