"""An instructor at a second terminal and a mission's timetable, through all processes of somebody's flight."""

import json
import math
import subprocess
import sys
import time

import pytest

from bench.rig import ROOT, Program, free_port, vehicle
from groundstation.messages import CommandKind, FlightMode, Phase
from groundstation.progress.importing import flights_in
from groundstation.recording import lanes
from groundstation.review.flight import Flight

pytestmark = [pytest.mark.flight, pytest.mark.timeout(240)]

MISSION = """
schema = 1
name = "busy"
title = "Wind comes up by itself"
[target]
position = [0.0, 0.0, 2.0]
hold_s = 300.0
[criteria]
time_limit_s = 400.0
[[event]]
kind = "wind"
velocity = [0.0, 2.0, 0.0]
"""


def groundstation(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", *map(str, arguments)],
        cwd=ROOT, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=150, check=False,
    )  # fmt: skip


def instruct(program, *arguments):
    return groundstation("instruct", "--run", program.process.pid, *arguments)


def done(program, *arguments):
    found = instruct(program, *arguments)
    assert (found.returncode, found.stderr) == (0, ""), arguments
    return found.stdout


def heard(program, text, *arguments):
    """Do something that is told to the trainee, who looks at the screen meanwhile; return its exit code."""
    acting = subprocess.Popen(
        [sys.executable, "-m", "groundstation.cli", "instruct", "--run", str(program.process.pid), *arguments],
        cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    program.until(lambda view: any(event.text == text for event in view.events), 20, text.decode())
    return acting.wait(30)


def asked_back(program, *names):
    """Return parameters as the vehicle itself tells them."""
    program.console.command(CommandKind.PARAMETERS)
    view = program.until(
        lambda view: any(each.kind == CommandKind.PARAMETERS and each.ok for each in view.answers), 60, "read"
    )
    return [view.parameters[name].value for name in names]


def test_what_is_let_happen_happens_to_the_vehicle_and_is_recorded(tmp_path):
    mission = tmp_path / "busy.toml"
    mission.write_text(MISSION)
    program = Program("--sim", "--mission", str(mission), "--logs", str(tmp_path), "--pilot", "zoe")
    until = program.until
    try:
        program.engage()
        assert asked_back(program, "SIM_WIND_E", "SIM_WIND_N") == [0.0, 2.0], "the timetable was kept"

        done(program, "wind", "3", "-1", "--turbulence", "0.5")
        assert asked_back(program, "SIM_WIND_E", "SIM_WIND_N", "SIM_WIND_TURB") == [3.0, -1.0, 0.5]
        done(program, "battery", "40")
        until(lambda view: abs(view.status.battery - 0.4) < 0.02, 10, "so much is left")
        done(program, "delay", "300")
        until(lambda view: 0.25 < view.status.rtt < 0.6, 15, "frames take their time")
        assert "round trip 300 ms" in done(program, "status")

        done(program, "device-loss", "4")
        until(lambda view: not view.device.present, 5, "the device is gone")
        view = until(lambda view: view.pilot.phase == Phase.DISENGAGED, 5, "the hand is uncoupled")
        assert view.status.mode in {FlightMode.OFFBOARD, FlightMode.HOLD}
        until(lambda view: view.status.mode == FlightMode.HOLD, 5, "the vehicle holds")
        until(lambda view: view.device.present, 10, "the device is there again")

        done(program, "link-loss", "4")
        until(lambda view: time.monotonic() - view.status.heard_t > 2.0, 10, "nothing is heard")
        until(lambda view: time.monotonic() - view.status.heard_t < 0.5, 20, "it is heard again")

        done(program, "calm")
        view = until(lambda view: view.status.rtt < 0.15, 15, "frames come at once")
        assert asked_back(program, "SIM_WIND_E", "SIM_WIND_N", "SIM_UP_DELAY") == [0.0, 0.0, 0.0]
        told = b" ".join(event.text for event in view.events)
        assert b"SIM_" not in told, "the trainee is told what a real vehicle shows, and no more"
        assert heard(program, b"Well done.", "say", "Well done.") == 0
        done(program, "land")
        until(lambda view: not view.status.armed, 30, "landed")
    finally:
        program.close()
    (path,) = tmp_path.glob("*.rrd")
    flight = Flight(path)
    states = [state for _, state in flight.states(lanes.INTERVENTION)]
    assert states[0] == "wind"
    assert states[-1] == "nothing"
    assert {"battery", "delay", "device lost", "link lost"} <= set(states)
    lines = [(line.source, line.text) for line in flight.events()]
    assert ("mission", "Wind 2.0 m/s from the south.") in lines
    assert ("instructor", "Haptic device lost for 4 s.") in lines
    assert ("instructor", "All taken back.") in lines
    # Whoever reads progress from it knows that an instructor had a hand in it.
    assert [each.instructed for each, _ in flights_in(path)] == [True]
    checked = groundstation("replay", path, "--check", "--json")
    assert (checked.returncode, json.loads(checked.stdout)["identical"]) == (0, True), checked.stderr


def test_a_real_vehicle_is_left_alone_but_may_be_held(tmp_path):
    port = free_port()
    with vehicle(port):
        program = Program("--connect", f"udpin://127.0.0.1:{port}", "--logs", str(tmp_path))
        try:
            program.until(lambda view: view.status and view.status.connected, 30, "connected")
            for act in (("gust", "5", "0"), ("device-loss", "5"), ("link-loss", "5"), ("calm",)):
                found = instruct(program, *act)
                assert (found.returncode, found.stdout) == (1, "")
                assert found.stderr.endswith("refused: the vehicle is real; this is for simulated ones.\n")
            view = program.console.snapshot()
            assert view.device is None or view.device.present or not math.isfinite(view.device.rate)
            assert "REAL vehicle" in done(program, "status")
            # On the ground there is nothing to hold: what counts is that the vehicle was asked.
            assert heard(program, b"The instructor commands Hold.", "hold") in {0, 1}
        finally:
            program.close()
