"""Which flight an instructor means, and how a trainee is doing in words."""

import math
from dataclasses import replace

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recording_support import a_pilot_state, a_run, a_status, a_vehicle_state

from groundstation.console import Snapshot
from groundstation.errors import InputError
from groundstation.instruct.flights import chosen, running_flights
from groundstation.instruct.telling import line, status
from groundstation.messages import MissionProgress, Phase
from groundstation.run import write_run
from groundstation.run_folder import Stay, sweep
from groundstation.training.mission import find_mission, load_mission


def flights(tmp_path):
    run = a_run(tmp_path / "flight")
    return [
        msgspec.structs.replace(run, run_id="11-aaaaaa", pilot="ada", mission=None),
        msgspec.structs.replace(run, run_id="22-bbbbbb", pilot="", simulated=False),
    ]


@pytest.mark.parametrize(
    ("name", "meant"), [("ada", 0), ("free", 0), ("11", 0), ("22-bbbbbb", 1), ("paper", 1), ("22", 1)]
)
def test_a_flight_is_named_by_pilot_mission_run_or_process(tmp_path, name, meant):
    there = flights(tmp_path)
    assert chosen(there, name) is there[meant]


def test_where_only_one_runs_it_needs_no_name(tmp_path):
    there = flights(tmp_path)[:1]
    assert chosen(there, None) is there[0]


@pytest.mark.parametrize(
    ("name", "count", "words"),
    [
        (None, 0, "no flight runs"),
        ("ada", 0, "no flight runs"),
        (
            None,
            2,
            r"choose one with --run: 11-aaaaaa \(ada, free\); 22-bbbbbb \(nobody by name, paper, a REAL",
        ),
        ("eve", 2, "--run eve: no such flight"),
        ("", 2, "no such flight"),
    ],
)
def test_what_is_not_clear_is_told_with_what_there_is(tmp_path, name, count, words):
    with pytest.raises(InputError, match=words):
        chosen(flights(tmp_path)[:count], name)


def test_a_flight_is_seen_while_somebody_is_in_it(tmp_path):
    run = a_run(tmp_path / "flight")
    write_run(run)
    try:
        stay = Stay(run.run_id)
        assert run.run_id in {each.run_id for each in running_flights()}
        stay.end()
        assert run.run_id not in {each.run_id for each in running_flights()}
    finally:
        sweep(run.run_id)


NOTHING = Snapshot(100.0, None, None, None, None, None, None, None, None, None, (), ())


def flying(**changed):
    pilot = a_pilot_state(100.0)
    pilot.phase, pilot.error[:] = Phase.ENGAGED, [3.0, 4.0, 0.0, 0.0]
    vehicle = a_status(100.0)
    vehicle.heard_t, vehicle.armed, vehicle.in_air = 100.0, 1, 1
    vehicle.rtt, vehicle.loss, vehicle.battery = 0.3, 0.1, 0.5
    progress = MissionProgress(
        t=100.0, stage=b"on the way", leg=1, legs=4, target_distance=7.0, clearance=1.25, collisions=1
    )
    state = a_vehicle_state(100.0)
    return replace(NOTHING, pilot=pilot, status=vehicle, progress=progress, vehicle=state, **changed)


def test_before_anything_is_known_it_says_so(tmp_path):
    told = dict(status(a_run(tmp_path / "flight"), NOTHING, "nothing"))
    assert told["vehicle"] == "no vehicle"
    assert told["mission"] == "no mission"
    assert told["link"] == "nothing heard yet"


def test_how_a_trainee_is_doing(tmp_path):
    told = dict(status(a_run(tmp_path / "flight"), flying(), "wind"))
    assert "engaged, error 5.00 m" in told["trainee"]
    assert told["vehicle"].startswith("Offboard, in the air, altitude 3.0 m")
    assert told["vehicle"].endswith("battery 50 %")
    assert told["mission"] == "on the way, point 2 of 4, 7.0 m to the target, clearance 1.2 m, 1 collision"
    assert told["link"] == "round trip 300 ms, 10 % lost"
    assert told["in force"] == "wind"
    assert told["score"] == "none yet"


def test_the_score_so_far_and_what_is_asked_for_are_told(tmp_path):
    view = flying()
    view.progress.score = b"12 of 100 so far: time 3/11, path 9/22"
    run = msgspec.structs.replace(a_run(tmp_path / "flight"), mission=load_mission(find_mission("hover")))
    told = dict(status(run, view, "nothing"))
    assert told["score"] == "12 of 100 so far: time 3/11, path 9/22"
    assert "from take-off to landing" in told["goal"]


def test_what_is_silent_or_old_is_said_to_be(tmp_path):
    told = dict(status(a_run(tmp_path / "flight"), flying(t=110.0), "nothing"))
    assert "the pilot process is silent" in told["trainee"]
    assert told["link"].startswith("silent for 10 s")
    assert "10 s ago" in told["vehicle"]


@given(st.floats(allow_nan=True), st.floats(allow_nan=True), st.integers(0, 255), st.integers(0, 255))
def test_no_number_is_too_odd_to_be_told(number, other, mode, phase):
    view = flying()
    view.status.rtt, view.status.battery, view.status.mode = number, other, mode
    view.pilot.phase, view.pilot.error[0] = phase, number
    view.progress.clearance = other if math.isfinite(other) else math.nan
    assert line(view, "nothing")
