"""What a flight came to, from its recording, as the mission's director saw it live."""

from __future__ import annotations

import msgspec
import pytest
from canned_flight import START, STEP_S, CannedFlight, canned_run

from groundstation.messages import HANDLE, PILOT_STATE, VEHICLE_STATE, VEHICLE_STATUS, Phase
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of
from groundstation.training.director import Director, Stage
from sim.airframe import load_airframe
from sim.environment.world import World

SECONDS = 45.0


def recorded(folder, run, seconds=SECONDS, director=None):
    """Fly the canned flight for a while and land it, to a file and before a director."""
    run = msgspec.structs.replace(run, log=str(folder / "flight"))
    session = Session(run, START, lambda _severity, text: pytest.fail(text))
    flight = CannedFlight(run)
    batch = Batch()
    for number in range(round(seconds / STEP_S)):
        flight.advance(STEP_S)
        view = flight.snapshot()
        if number == round(seconds / STEP_S) - 1:
            view.status.armed = view.status.in_air = 0
        view.status.t = view.t - STEP_S / 2
        batch.add(VEHICLE_STATUS, [view.status])
        batch.add(VEHICLE_STATE, [replace_t(view.vehicle, view.t)])
        batch.add(HANDLE, [view.handle])
        batch.add(PILOT_STATE, [view.pilot])
        if director:
            x, y, z, _ = view.vehicle.position
            director.vehicle(
                view.t, (x, y, z, 0.0), in_air=bool(view.status.in_air), armed=bool(view.status.armed)
            )
            if view.pilot.phase == Phase.ENGAGED:
                director.controller(tuple(view.pilot.error[:3]), tuple(view.handle.force))
    session.take(batch)
    session.close()
    return Flight(run.recording)


def replace_t(record, t):
    record.t = t
    return record


@pytest.fixture(scope="module")
def live_and_recorded(tmp_path_factory):
    run = canned_run()
    mission = run.mission
    director = Director(
        mission, World(mission.obstacle), radius=load_airframe(mission.vehicle.airframe).radius
    )
    return director, recorded(tmp_path_factory.mktemp("outcome"), run, director=director)


def test_the_recording_tells_what_was_seen_live(live_and_recorded):
    director, flight = live_and_recorded
    outcome = outcome_of(flight)
    live, found = director.figures, outcome.figures
    assert director.stage is Stage.DONE
    assert live.error_count == found.error_count > 1000
    for name in ("path", "rms_error", "max_force", "duration", "collisions", "least_clearance"):
        assert getattr(found, name) == pytest.approx(getattr(live, name), abs=1e-6), name
    assert outcome.shortcomings == tuple(director.shortcomings())
    assert outcome.completed is (not director.shortcomings())
    assert outcome.score is not None
    assert 0.0 < outcome.score.points < 100.0


def test_twice_the_same_numbers(live_and_recorded):
    _, flight = live_and_recorded
    assert outcome_of(flight).score == outcome_of(Flight(flight.path)).score


def test_a_flight_without_a_target_has_no_score(tmp_path):
    run = canned_run()
    session = Session(
        msgspec.structs.replace(
            run,
            log=str(tmp_path / "flight"),
            mission=msgspec.structs.replace(run.mission, target=None, route=()),
        ),
        START,
        lambda _severity, text: pytest.fail(text),
    )
    flight = CannedFlight(run)
    flight.advance(3.0)
    view = flight.snapshot()
    batch = Batch()
    batch.add(VEHICLE_STATUS, [view.status])
    batch.add(VEHICLE_STATE, [replace_t(view.vehicle, view.t)])
    session.take(batch)
    session.close()
    outcome = outcome_of(Flight(tmp_path / "flight.rrd"))
    assert (outcome.completed, outcome.score) == (None, None)
    assert outcome.result == "in the air at the end of the recording"


def test_a_flight_that_recorded_nothing_did_not_take_off(tmp_path):
    run = msgspec.structs.replace(canned_run(), log=str(tmp_path / "flight"))
    Session(run, START, lambda _severity, text: pytest.fail(text)).close()
    assert outcome_of(Flight(run.recording)).result == "did not take off"


def test_without_a_mission_there_is_nothing_to_judge(tmp_path):
    run = msgspec.structs.replace(canned_run(mission=False), log=str(tmp_path / "flight"))
    Session(run, START, lambda _severity, text: pytest.fail(text)).close()
    assert outcome_of(Flight(run.recording)).result == "no mission"
