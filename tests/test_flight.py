"""Whole flights with all processes over real sockets: a mission flown, summed up, recorded, and nothing left over.

What becomes of a flight when something fails: `test_flight_faults.py`.
"""

import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from flight_support import LONG, gone, headless, left_behind, until
from pymavlink import mavutil

from bench.rig import ROOT, Program
from groundstation.recording import schema
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]


@pytest.mark.parametrize(("mission", "path_m", "force_n"), [("hover", 2.0, 0.0), ("paper", 12.0, 1.0)])
def test_a_mission_is_flown_summed_up_and_recorded(tmp_path, mission, path_m, force_n):
    done = headless("--sim", "--headless", "--mission", mission, "--json", "--logs", str(tmp_path))
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["completed"] is True
    assert summary["collisions"] == 0
    assert summary["final_error_m"] <= 0.2
    assert 5 < summary["duration_s"] < 60
    assert summary["path_m"] > path_m
    assert summary["max_force_n"] > force_n
    servo = summary["servo"]
    assert servo["rate_hz"] == pytest.approx(1000)
    assert servo["ticks"] > 5000
    assert "taking off" in done.stderr
    log = mavutil.mavlink_connection(summary["logs"]["tlog"])
    kinds = set()
    while (message := log.recv_match()) is not None:
        kinds.add(message.get_type())
    log.close()
    assert {"HEARTBEAT", "SET_POSITION_TARGET_LOCAL_NED", "LOCAL_POSITION_NED", "COMMAND_LONG"} <= kinds
    flight = Flight(Path(summary["logs"]["rrd"]))
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


def test_a_mission_that_fails_its_criteria_exits_1_and_says_why(tmp_path):
    mission = tmp_path / "hasty.toml"
    mission.write_text(
        'schema = 1\nname = "hasty"\ntitle = "No time"\n[target]\nposition = [0.0, 0.0, 2.0]\nhold_s = 1.0\n'
        "[criteria]\ntime_limit_s = 2.0\n"
    )
    done = headless("--sim", "--headless", "--mission", str(mission), "--logs", str(tmp_path))
    assert done.returncode == 1, done.stderr
    assert "is over 2 s" in done.stdout


@pytest.mark.parametrize("role", ["pilot", "sim"])
def test_a_headless_flight_that_loses_a_process_ends_with_1_and_says_which(tmp_path, role):
    mission = tmp_path / "long.toml"
    mission.write_text(LONG)
    program = Program("--sim", "--headless", "--mission", str(mission), "--logs", str(tmp_path))
    children = program.pids()
    program.until(lambda view: view.status and view.status.armed, 30, "armed")
    os.kill(program.pids()[role], signal.SIGKILL)
    program.process.wait(30)
    program.close()
    assert program.process.returncode == 1
    assert f"The {role} process has died (killed by SIGKILL)".encode() in program.screen
    assert all(map(gone, children.values()))
    assert not left_behind(program.process.pid)


def test_a_headless_flight_that_is_interrupted_cleans_up(tmp_path):
    mission = tmp_path / "long.toml"
    mission.write_text(LONG)
    program = Program("--sim", "--headless", "--mission", str(mission), "--logs", str(tmp_path))
    program.until(lambda view: view.status and view.status.connected, 30, "connected")
    children = program.pids()
    program.process.send_signal(signal.SIGINT)
    assert program.process.wait(30) == 130
    program.close()
    assert b"Traceback" not in program.screen
    assert all(map(gone, children.values()))
    assert not left_behind(program.process.pid)


def test_nothing_is_left_behind_after_a_good_end(tmp_path):
    program = Program("--sim", "--mission", "hover", "--logs", str(tmp_path))
    program.until(lambda view: view.status and view.status.connected, 20, "connected")
    children = program.pids()
    assert {"pilot", "link", "recorder", "sim"} <= set(children)
    program.close()
    assert all(map(gone, children.values()))
    assert not left_behind(program.process.pid)


def flown_over(url, tmp_path) -> dict:
    done = headless(
        "--connect", url, "--headless", "--confirm-real", "--mission", "hover", "--json", "--logs", str(tmp_path)
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_vehicle_behind_tcp_is_flown_the_same(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "sim", "--connect", f"tcpin://127.0.0.1:{port}", "--quiet"]
    simulated = subprocess.Popen(command, cwd=ROOT)
    try:
        until(lambda: listens(port), 10, "the vehicle listens")
        assert flown_over(f"tcpout://127.0.0.1:{port}", tmp_path)["simulated"] is False
    finally:
        simulated.terminate()
        simulated.wait(10)


def listens(port) -> bool:
    return f":{port:04X} 00000000:0000 0A" in Path("/proc/net/tcp").read_text()
