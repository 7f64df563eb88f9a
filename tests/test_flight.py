"""Whole flights with all processes over real UDP: a mission flown, processes killed and frozen, nothing left over.

The vehicle's side is looked at where it counts: at its socket, through a relay.
"""

import contextlib
import json
import math
import os
import pty
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import tty
from pathlib import Path

import numpy as np
import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

from bench.rig import ROOT, Hand, Program, Tap, vehicle
from groundstation.messages import Phase
from groundstation.recording import schema
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]

PX4_AUTO, PX4_LOITER, PX4_RETURN, PX4_OFFBOARD = 4, 3, 5, 6
LONG = """
schema = 1
name = "long"
title = "A long stay in the air"
[target]
position = [0.0, 0.0, 2.0]
hold_s = 500.0
[criteria]
time_limit_s = 600.0
"""


def left_behind(pid: int) -> list[Path]:
    return [
        *Path("/dev/shm").glob(f"groundstation-{pid}-*"),
        *Path(tempfile.gettempdir()).glob(f"groundstation-{pid}-*"),
    ]


def descendants(pid: int) -> list[int]:
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if int((folder / "stat").read_text().rpartition(")")[2].split()[1]) == pid:
                found.append(int(folder.name))
        except (OSError, ValueError):
            continue
    return found


def until(condition, within_s, what):
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if result := condition():
            return result
        time.sleep(0.02)
    pytest.fail(f"within {within_s} s it did not happen: {what}")


def headless(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", *arguments],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        cwd=ROOT,
        timeout=170,
        check=False,
    )


def messages(datagrams, kind):
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    for t, data in datagrams:
        for message in parser.parse_buffer(data) or ():
            if message.get_type() == kind:
                yield t, message


def px4_mode(heartbeat) -> tuple[int, int]:
    return heartbeat.custom_mode >> 16 & 0xFF, heartbeat.custom_mode >> 24 & 0xFF


@pytest.fixture
def flight(tmp_path):
    """A flight by hand on the screen, engaged and pushed forward, with the vehicle behind a tap."""
    mission = tmp_path / "long.toml"
    mission.write_text(LONG)
    hand, tap = Hand(str(tmp_path / "hand.sock")), Tap()
    with vehicle(tap.vehicle_port, "--mission", str(mission)) as simulated:
        program = Program(
            "--connect", f"udpout://127.0.0.1:{tap.program_port}", "--device", f"virtual:{tmp_path / 'hand.sock'}",
            "--mission", str(mission), "--logs", str(tmp_path / "logs"),
        )  # fmt: skip
        program.tap, program.hand, program.simulated, program.logs = tap, hand, simulated, tmp_path / "logs"
        try:
            program.engage()
            hand.put((0.06, 0.0, 0.0))
            until(lambda: speed(tap) > 0.5, 10, "the vehicle follows the hand")
            yield program
        finally:
            program.close()
            hand.close()
            tap.close()


def speed(tap) -> float:
    found = [message for _, message in messages(tap.heard[-60:], "LOCAL_POSITION_NED")]
    return math.hypot(found[-1].vx, found[-1].vy, found[-1].vz) if found else 0.0


def holds(tap) -> bool:
    modes = [px4_mode(message) for _, message in messages(tap.heard[-400:], "HEARTBEAT")]
    return bool(modes) and modes[-1] == (PX4_AUTO, PX4_LOITER) and speed(tap) < 0.2


def is_safe(tap) -> bool:
    """The vehicle holds, or returns, which is what PX4 does by itself when setpoints end and there are no sticks."""
    modes = [px4_mode(message) for _, message in messages(tap.heard[-400:], "HEARTBEAT")]
    return holds(tap) or (bool(modes) and modes[-1] == (PX4_AUTO, PX4_RETURN))


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


@pytest.mark.parametrize("role", ["pilot", "link", "recorder"])
def test_a_killed_process_ends_in_a_vehicle_that_is_safe_and_is_told(flight, role):
    os.kill(flight.pids()[role], signal.SIGKILL)
    until(lambda: is_safe(flight.tap), 6, "the vehicle is safe")
    told = f"The {role} process has died".encode()
    until(
        lambda: any(told in event.text for event in flight.console.snapshot().events), 5, "the death is told"
    )
    if role != "pilot":
        view = flight.until(lambda view: view.pilot.phase == Phase.DISENGAGED, 5, "uncoupled")
        assert math.hypot(*view.handle.force) == 0.0
    flight.process.send_signal(signal.SIGTERM)
    flight.process.wait(30)
    assert not descendants(flight.process.pid)
    assert not left_behind(flight.process.pid)


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
    assert not any(Path(f"/proc/{pid}").exists() for pid in children.values())
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
    assert not any(Path(f"/proc/{pid}").exists() for pid in children.values())
    assert not left_behind(program.process.pid)


def test_a_killed_screen_takes_all_with_it_and_the_vehicle_holds(flight):
    pids = flight.pids()
    os.kill(flight.process.pid, signal.SIGKILL)
    flight.process.wait(10)
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in pids.values()), 20, "the others end")
    assert not left_behind(flight.process.pid)
    until(lambda: b"\x1b[?1049l" in flight.screen, 5, "the terminal is given back")


def test_a_frozen_pilot_lets_no_old_setpoint_out(flight):
    pid = flight.pids()["pilot"]
    os.kill(pid, signal.SIGSTOP)
    stopped = time.monotonic()
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    assert max(t for t, _ in flight.tap.setpoints) - stopped < 0.15 + 0.05
    flight.tap.setpoints.clear()
    os.kill(pid, signal.SIGCONT)
    time.sleep(1.5)
    assert flight.tap.setpoints == []
    assert flight.console.snapshot().pilot.phase == Phase.DISENGAGED


def test_a_frozen_link_lets_nothing_out_and_nothing_old_when_it_wakes(flight):
    pid = flight.pids()["link"]
    os.kill(pid, signal.SIGSTOP)
    stopped = time.monotonic()
    until(lambda: is_safe(flight.tap), 6, "the vehicle is safe by its own failsafe")
    assert max(t for t, _ in flight.tap.setpoints) - stopped < 0.05
    flight.tap.setpoints.clear()
    os.kill(pid, signal.SIGCONT)
    time.sleep(2.0)
    assert flight.tap.setpoints == []


def test_a_frozen_link_is_noticed_by_the_vehicle_within_its_time(flight):
    """Offboard loss is 1.0 s; with the stop in the middle of a 20 ms period, 1.2 s is the bar."""
    os.kill(flight.pids()["link"], signal.SIGSTOP)
    stopped = time.monotonic()
    texts = until(
        lambda: [
            t
            for t, message in messages(flight.tap.heard, "STATUSTEXT")
            if "ffboard" in message.text and t > stopped
        ],
        5,
        "the vehicle says that it lost offboard",
    )
    os.kill(flight.pids()["link"], signal.SIGCONT)
    assert texts[0] - stopped < 1.2 + 0.1


def test_a_silent_hand_ends_in_hold(flight):
    flight.hand.close()
    flight.until(lambda view: view.pilot.phase == Phase.DISENGAGED, 5, "uncoupled")
    until(lambda: holds(flight.tap), 6, "the vehicle holds")


def test_another_that_takes_over_is_not_fought(flight):
    # A second ground station asks the vehicle to hold, straight at its socket.
    other = mavlink.MAVLink(None, srcSystem=254, srcComponent=190)
    hold = other.command_long_encode(1, 1, 176, 0, 1 | 128, PX4_AUTO, PX4_LOITER, 0, 0, 0, 0)
    flight.tap.inject(bytes(hold.pack(other)))
    flight.until(lambda view: view.pilot.phase == Phase.DISENGAGED, 5, "uncoupled")
    time.sleep(0.3)
    flight.tap.setpoints.clear()
    time.sleep(1.5)
    assert flight.tap.setpoints == []
    assert holds(flight.tap)


def test_nothing_is_left_behind_after_a_good_end(tmp_path):
    program = Program("--sim", "--mission", "hover", "--logs", str(tmp_path))
    program.until(lambda view: view.status and view.status.connected, 20, "connected")
    children = program.pids()
    assert {"pilot", "link", "recorder", "sim"} <= set(children)
    program.close()
    assert not any(Path(f"/proc/{pid}").exists() for pid in children.values())
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


def test_a_vehicle_behind_a_serial_port_is_flown_the_same(tmp_path):
    controller, device = pty.openpty()
    air = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    air.bind(("127.0.0.1", 0))
    over = threading.Event()

    def radio() -> None:
        vehicle_address = None
        while not over.is_set():
            for ready in select.select([controller, air], [], [], 0.1)[0]:
                if ready is air:
                    data, vehicle_address = air.recvfrom(65536)
                    # Nobody reads before and after the flight: then a radio loses what does not fit.
                    with contextlib.suppress(BlockingIOError):
                        os.write(controller, data)
                elif vehicle_address:
                    air.sendto(os.read(controller, 4096), vehicle_address)

    tty.setraw(device)
    os.set_blocking(controller, False)
    thread = threading.Thread(target=radio)
    thread.start()
    try:
        with vehicle(air.getsockname()[1]):
            assert flown_over(f"serial://{os.ttyname(device)}:57600", tmp_path)["completed"] is True
    finally:
        over.set()
        thread.join()
        air.close()
        os.close(controller)
        os.close(device)


def test_a_terminal_that_goes_takes_all_with_it_and_the_vehicle_holds(flight):
    pids = flight.pids()
    flight.hang_up()
    flight.process.wait(20)
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in pids.values()), 20, "the others end")
    assert not left_behind(flight.process.pid)
