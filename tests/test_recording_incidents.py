"""What went wrong stands in a lane and in the scene, and numbers stand beside what they must not exceed."""

from __future__ import annotations

import math

import numpy as np
from recording_support import a_vehicle_state, batch_of, rows

from groundstation.config import Shield
from groundstation.messages import (
    DEVICE_REPORT,
    EVENT,
    HANDLE,
    MISSION_PROGRESS,
    VEHICLE_STATE,
    DeviceReport,
    Event,
    Handle,
    MissionProgress,
    Severity,
)
from groundstation.recording import entities, lanes, schema
from groundstation.recording.gauges import Gauges
from groundstation.recording.incidents import Incidents

START = 50.0


def an_event(t, severity, text):
    return Event(t=START + t, severity=severity, source=b"pilot", text=text)


def at(t, x):
    return a_vehicle_state(START + t, position=(x, 0.0, 2.0, 0.0))


def places(chunks):
    (chunk,) = [chunk for chunk in chunks if chunk.path == entities.INCIDENTS]
    (positions, *_) = [c for c in chunk.columns if "positions" in c.component_descriptor().component]
    return positions.as_arrow_array().to_pylist()


def test_an_alarm_is_shown_for_a_moment_and_where_the_vehicle_was():
    incidents = Incidents(START)
    list(incidents.chunks(batch_of(VEHICLE_STATE, at(0.0, 1.0), at(1.0, 2.0))))
    batch = batch_of(EVENT, an_event(1.5, Severity.ALARM, b"The link is silent."))
    batch.add(VEHICLE_STATE, [at(1.4, 3.0), at(1.6, 4.0)])
    chunks = list(incidents.chunks(batch))
    assert rows(c for c in chunks if c.path == lanes.ALERT.path)[lanes.ALERT.path] == [
        (1.5, lanes.ALARM),
        (2.0, lanes.QUIET),
    ]
    assert places(chunks) == [[[3.0, 0.0, 2.0]]]


def test_before_the_first_incident_the_lane_is_quiet():
    (chunk,) = Incidents(START).chunks(batch_of(VEHICLE_STATE, at(0.0, 1.0)))
    assert rows([chunk]) == {lanes.ALERT.path: [(0.0, lanes.QUIET)]}


def test_a_warning_is_in_the_lane_only_and_information_nowhere():
    incidents = Incidents(START)
    list(incidents.chunks(batch_of(VEHICLE_STATE, at(0.0, 1.0))))
    batch = batch_of(EVENT, an_event(1.0, Severity.WARNING, b"slow"), an_event(3.0, Severity.INFO, b"well"))
    (chunk,) = incidents.chunks(batch)
    assert rows([chunk]) == {lanes.ALERT.path: [(1.0, lanes.WARNING), (1.5, lanes.QUIET)]}


def test_what_follows_at_once_is_one_incident_of_the_worst_kind():
    incidents = Incidents(START)
    list(incidents.chunks(batch_of(VEHICLE_STATE, at(0.0, 1.0))))
    batch = batch_of(
        EVENT, an_event(1.0, Severity.WARNING, b"near"), an_event(1.2, Severity.ALARM, b"The motors are off.")
    )
    batch.add(MISSION_PROGRESS, [MissionProgress(t=START + 1.1, collisions=1)])
    chunks = list(incidents.chunks(batch))
    assert rows(c for c in chunks if c.path == lanes.ALERT.path)[lanes.ALERT.path][0] == (
        1.0,
        lanes.COLLISION,
    )
    assert len(places(chunks)) == 1


def test_each_collision_is_counted_once():
    incidents = Incidents(START)
    first = batch_of(MISSION_PROGRESS, MissionProgress(t=START + 1.0, collisions=1))
    again = batch_of(MISSION_PROGRESS, MissionProgress(t=START + 9.0, collisions=1))
    words = [word for _, word in rows(incidents.chunks(first))[lanes.ALERT.path]]
    assert words == [lanes.QUIET, lanes.COLLISION, lanes.QUIET]
    assert list(incidents.chunks(again)) == []


def numbers(chunks):
    return {
        chunk.path: np.array(
            [np.atleast_1d(cell) for cell in next(iter(chunk.columns)).as_arrow_array().to_pylist()]
        )
        for chunk in chunks
    }


def test_the_force_is_drawn_beside_what_the_device_can_render():
    gauges = Gauges(START, Shield())
    batch = batch_of(
        HANDLE, *(Handle(t=START + k * 0.001, force=(0.0, 3.0 * (k == 7), 4.0)) for k in range(40))
    )
    batch.add(DEVICE_REPORT, [DeviceReport(t=START, present=1, force_limit=8.0)])
    assert numbers(gauges.chunks(batch))[schema.FORCE_SIZE.path].tolist() == [[5.0, 8.0], [4.0, 8.0]]


def test_a_margin_is_drawn_only_where_the_guard_keeps_one_and_something_stands():
    progress = [MissionProgress(t=START, clearance=2.0), MissionProgress(t=START + 1, clearance=math.inf)]
    batch = batch_of(MISSION_PROGRESS, *progress)
    kept = numbers(Gauges(START, Shield(margin=0.3)).chunks(batch))[schema.MARGIN.path]
    assert kept[0] == [0.3]
    assert np.isnan(kept[1])
    assert np.isnan(numbers(Gauges(START, Shield(guard="off")).chunks(batch))[schema.MARGIN.path]).all()
