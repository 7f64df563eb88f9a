"""How flights with all processes end: failed, interrupted, with a process lost; and nothing is left over.

What a flight that goes well leaves: `test_flight_flown.py`. What becomes of the vehicle when something fails:
`test_flight_faults.py`.
"""

import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from flight_support import LONG, gone, headless, left_behind, until

from bench.rig import ROOT, Program

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]


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
