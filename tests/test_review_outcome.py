"""What a flight came to, from its recording, as the mission's director saw it live."""

from __future__ import annotations

import msgspec
import pytest
from canned_flight import START, STEP_S, CannedFlight, canned_run

from groundstation.cli import main
from groundstation.messages import HANDLE, PILOT_STATE, VEHICLE_STATE, VEHICLE_STATUS
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of
from groundstation.training.attempts import Attempts
from groundstation.training.director import Stage
from groundstation.training.judgement import judgement_of
from groundstation.training.measures import Measures
from groundstation.training.sights import Sights
from sim.airframe import load_airframe

SECONDS = 45.0


def recorded(folder, run, seconds=SECONDS, attempts=None):
    """Fly the canned flight for a while and land it, to a file and before who measures it live."""
    run = msgspec.structs.replace(run, log=str(folder / "flight"))
    session = Session(run, START, lambda _severity, text: pytest.fail(text))
    flight, sights, batch = CannedFlight(run), Sights(), Batch()
    for number in range(round(seconds / STEP_S)):
        flight.advance(STEP_S)
        view = flight.snapshot()
        if number == round(seconds / STEP_S) - 1:
            view.status.armed = view.status.in_air = 0
        view.status.t = view.t - STEP_S / 2
        view.vehicle.t = view.t
        for record in (view.vehicle, view.status, view.pilot, view.handle):
            # A clock counts whole nanoseconds.
            record.t = round(record.t * 1e9) / 1e9
        batch.add(VEHICLE_STATUS, [view.status])
        batch.add(VEHICLE_STATE, [view.vehicle])
        batch.add(HANDLE, [view.handle])
        batch.add(PILOT_STATE, [view.pilot])
        for sight in sights.take([view.vehicle], [view.status], [view.pilot], [view.handle]):
            if attempts:
                attempts.show(sight)
    session.take(batch)
    session.close()
    for sight in sights.rest():
        if attempts:
            attempts.show(sight)
    return Flight(run.recording)


def replace_t(record, t):
    record.t = t
    return record


@pytest.fixture(scope="module")
def live_and_recorded(tmp_path_factory):
    par = Measures(time_s=20.0, rms_error_m=0.5, smoothness=-3.0)
    run = msgspec.structs.replace(canned_run(), par=par, par_from="the expert operator on seed 0")
    attempts = Attempts(run.mission, load_airframe(run.mission.vehicle.airframe).radius)
    return attempts, recorded(tmp_path_factory.mktemp("outcome"), run, attempts=attempts)


def test_the_recording_tells_to_the_last_bit_what_was_measured_live(live_and_recorded):
    attempts, flight = live_and_recorded
    live, outcome = attempts.judged, outcome_of(flight)
    assert live.director.stage is Stage.DONE
    assert len(live.hand_rows) > 1000
    assert flight.par.time_s == 20.0
    judgement = judgement_of(live, flight.par)
    assert msgspec.to_builtins(judgement.measures) == msgspec.to_builtins(outcome.judgement.measures)
    assert repr(judgement) == repr(outcome.judgement)
    assert repr(live.director.figures) == repr(outcome.figures)
    assert outcome.completed is judgement.passed
    assert 0.0 < outcome.score.points < 100.0


def test_twice_the_same_numbers(live_and_recorded):
    _, flight = live_and_recorded
    assert repr(outcome_of(flight).judgement) == repr(outcome_of(Flight(flight.path)).judgement)


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


def code_of(*arguments: str) -> object:
    with pytest.raises(SystemExit) as left:
        main(arguments)
    return left.value.code


def test_the_score_of_a_recording_is_told_in_lines(live_and_recorded, capsys):
    _, flight = live_and_recorded
    outcome = outcome_of(flight)
    assert code_of("review", str(flight.path), "--score") == (0 if outcome.completed else 1)
    told = capsys.readouterr().out
    assert told.startswith(f"{flight.mission.name}: {outcome.result}\n")
    assert f"{outcome.score.points:.1f} of 100, held against the expert operator on seed 0" in told
    first = outcome.judgement.story[0]
    assert f"(--at {first.t - flight.start:.1f}), {first.part}: {first.words}" in told


def test_a_flight_of_no_mission_has_no_score_to_tell(tmp_path, capsys):
    run = msgspec.structs.replace(canned_run(mission=False), log=str(tmp_path / "flight"))
    Session(run, START, lambda _severity, text: pytest.fail(text)).close()
    assert code_of("review", str(run.recording), "--score") == 2
    assert "nothing to be scored" in capsys.readouterr().err


def test_a_moment_that_is_no_time_is_refused(capsys):
    assert code_of("review", "1", "--at", "-3") == 2
    assert "--at" in capsys.readouterr().err
