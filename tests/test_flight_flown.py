"""Two missions flown once by all processes over real sockets, and looked at from all sides.

The summary, the MAVLink log, the recording, the score, and the pilot's decisions made once more on what was recorded.
"""

import functools
import json
import subprocess
import sys
from pathlib import Path

import msgspec
import numpy as np
import pytest
from flight_support import headless
from pymavlink import mavutil

from bench.rig import ROOT
from groundstation.recording import schema
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Fly a mission when it is first asked for; return what was said on stderr, the summary and the recording."""

    @functools.cache
    def fly(mission):
        logs = tmp_path_factory.mktemp(mission)
        done = headless("--sim", "--headless", "--mission", mission, "--json", "--logs", str(logs))
        assert done.returncode == 0, done.stderr
        summary = json.loads(done.stdout)
        return done.stderr, summary, Path(summary["logs"]["rrd"])

    return fly


@pytest.mark.parametrize(("mission", "path_m", "force_n"), [("hover", 2.0, 0.0), ("paper", 12.0, 1.0)])
def test_a_mission_is_flown_and_summed_up(flown, mission, path_m, force_n):
    told, summary, _ = flown(mission)
    assert summary["completed"] is True
    assert summary["collisions"] == 0
    assert summary["final_error_m"] <= 0.2
    assert 5 < summary["duration_s"] < 60
    assert summary["path_m"] > path_m
    assert summary["max_force_n"] > force_n
    servo = summary["servo"]
    assert servo["rate_hz"] == pytest.approx(1000)
    assert servo["ticks"] > 5000
    assert "taking off" in told


@pytest.mark.parametrize("mission", ["hover", "paper"])
def test_it_is_recorded(flown, mission):
    _, summary, path = flown(mission)
    log = mavutil.mavlink_connection(summary["logs"]["tlog"])
    kinds = set()
    while (message := log.recv_match()) is not None:
        kinds.add(message.get_type())
    log.close()
    assert {"HEARTBEAT", "SET_POSITION_TARGET_LOCAL_NED", "LOCAL_POSITION_NED", "COMMAND_LONG"} <= kinds
    flight = Flight(path)
    # Every attitude at its own rate, whose yaw is that of the states; every command with its answer.
    t, attitudes = flight.series(schema.RAW_ATTITUDE)
    assert len(t) > 20 * summary["duration_s"]
    assert (np.diff(attitudes[:, 3]) >= 0.0).all()
    state_t, states = flight.series(schema.POSITION)
    yaw = attitudes[np.searchsorted(t, state_t, side="right") - 1, 2][len(state_t) // 2]
    assert yaw == pytest.approx(states[len(state_t) // 2, 3], abs=0.05)
    asked, answered = (set(flight.series(each).values[:, 0]) for each in (schema.COMMANDED, schema.ANSWERED))
    assert asked
    assert asked == answered
    outcome = outcome_of(flight)
    assert outcome.completed is True
    assert outcome.figures.final_error == pytest.approx(summary["final_error_m"], abs=0.01)
    assert outcome.figures.path == pytest.approx(summary["path_m"], rel=0.02)


def test_live_and_from_its_recording_a_flight_has_the_same_numbers(flown):
    _, live, path = flown("paper")
    outcome = outcome_of(Flight(path))
    assert live["measures"] == msgspec.to_builtins(outcome.judgement.measures)
    assert live["measures"]["reached"] == 1.0
    assert live["score"]["points"] == outcome.score.points
    assert [part["points"] for part in live["score"]["parts"]] == [
        part.points for part in outcome.score.parts
    ]
    assert [each["lost"] for each in live["story"]] == [each.lost for each in outcome.judgement.story]
    assert repr(outcome_of(Flight(path)).judgement) == repr(outcome.judgement)


def replay(*arguments) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", "replay", *map(str, arguments)],
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )


def test_its_pilot_decides_the_same_on_the_recorded_inputs(flown):
    _, _, path = flown("hover")
    checked = replay(path, "--check", "--json")
    told = json.loads(checked.stdout)
    assert (checked.returncode, told["identical"], told["differences"]) == (0, True, []), checked.stderr
    assert told["ticks"] == len(Flight(path).series(schema.HANDLE_FORCE).t) > 10_000
    assert told["coupled"] >= 1
    assert told["ending"] == ""
    changed = replay(path, "--check", "--set", "control.k1=[1.3,1.2,1.2,1.0]")
    assert changed.returncode == 1
    assert changed.stdout.startswith("different at tick ")
