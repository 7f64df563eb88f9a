"""Faults on this side, done to a flight that is coupled: the vehicle's side shows what became of each.

Processes, device, disk, viewer, clocks, numbers; those of the way to the vehicle are in `test_flight_faults_link.py`.
"""

import contextlib
import datetime
import itertools
import math
import os
import resource
import shutil
import signal
import socket
import struct
import subprocess
import threading
import time
from pathlib import Path

import pytest
from flight_support import (
    OURS,
    Stage,
    asked,
    descendants,
    gone,
    holds,
    is_safe,
    left_behind,
    messages,
    speed,
    until,
)
from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

from drivers import stick
from groundstation.messages import CommandKind, Phase, Severity
from groundstation.recording import schema
from groundstation.review.flight import Flight

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]

FAULTS = Path(__file__).parent / "faults"
STALE_S = 0.15
# What a shared machine may add to a time that is measured from outside.
SLACK_S = 0.05
HOUR_NS = 3_600_000_000_000


@pytest.fixture(scope="module")
def viewer():
    """Listen as a viewer that takes connections and reads nothing."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        taken: list[socket.socket] = []

        def take() -> None:
            with contextlib.suppress(OSError):
                while True:
                    taken.append(listener.accept()[0])

        thread = threading.Thread(target=take, daemon=True)
        thread.start()
        yield listener.getsockname()[1]
        listener.shutdown(socket.SHUT_RDWR)
        thread.join()
        for connection in taken:
            connection.close()


@pytest.fixture(scope="module")
def clocks(tmp_path_factory):
    """A file of what the program's clocks are shifted by, and, where there is a compiler, what shifts them."""
    folder = tmp_path_factory.mktemp("clocks")
    shifts = folder / "shifts"
    shifts.write_bytes(bytes(16))
    compiler = shutil.which("cc")
    if compiler is None:
        return shifts, {}
    library = folder / "clocks.so"
    subprocess.run([compiler, "-O1", "-shared", "-fPIC", "-o", library, FAULTS / "clocks.c"], check=True)
    return shifts, {"LD_PRELOAD": str(library), "SHIFTED_CLOCKS": str(shifts)}


@pytest.fixture(scope="module")
def stage(tmp_path_factory, viewer, clocks):
    # Every one of these faults happens beside a viewer that hangs.
    it = Stage(
        tmp_path_factory.mktemp("faults"), "--viewer", f"127.0.0.1:{viewer}",
        environment={"PYTHONPATH": str(FAULTS), **clocks[1]},
    )  # fmt: skip
    yield it
    it.close()


@pytest.fixture
def flight(stage):
    return stage.coupled()


def shift(clocks, wall_ns: int, asleep_ns: int) -> None:
    """Change the program's clocks in place: its processes have the file mapped."""
    shifts, environment = clocks
    if not environment:
        pytest.skip("no C compiler to build what shifts the clocks; install gcc")
    with shifts.open("r+b") as file:
        file.write(struct.pack("<qq", wall_ns, asleep_ns))


def pace(flight, seconds: float) -> list[float]:
    """Return the gaps between setpoints on the wire, s, over a while from now."""
    flight.tap.setpoints.clear()
    time.sleep(seconds)
    sent = [t for t, _ in flight.tap.setpoints]
    assert len(sent) > 30 * seconds
    return [later - earlier for earlier, later in itertools.pairwise(sent)]


def last_moving(flight, since: float) -> float:
    """Return how long after a moment the last setpoint left that asks for motion, s."""
    return max(
        (t - since for t, data in flight.tap.setpoints if math.hypot(*asked(data)) > 0.05), default=0.0
    )


# Processes that hang


def test_a_frozen_pilot_lets_no_old_setpoint_out(flight):
    stopped = flight.signal(signal.SIGSTOP, "pilot")
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    assert max(t for t, _ in flight.tap.setpoints) - stopped < STALE_S + SLACK_S
    flight.signal(signal.SIGCONT, "pilot")
    flight.stays_uncoupled(1.5)


def lost_offboard(flight, since: float) -> float:
    """Return when the vehicle said that it lost the setpoints, s after a moment."""

    def said() -> float:
        texts = messages(flight.tap.heard[-800:], "STATUSTEXT")
        return next((t for t, message in texts if "ffboard" in message.text and t > since), 0.0)

    return until(said, 5, "the vehicle says that it lost offboard") - since


def test_a_frozen_link_lets_nothing_out_and_nothing_old_when_it_wakes(flight):
    """Offboard loss is 1.0 s; with the stop in the middle of a 20 ms period, 1.2 s is the bar."""
    stopped = flight.signal(signal.SIGSTOP, "link")
    try:
        assert lost_offboard(flight, stopped) < 1.2 + SLACK_S
        until(lambda: is_safe(flight.tap), 6, "the vehicle is safe by its own failsafe")
        assert max(t for t, _ in flight.tap.setpoints) - stopped < SLACK_S
        asked_t = time.monotonic()
        flight.program.console.command(CommandKind.KILL)
        time.sleep(2.1)
    finally:
        flight.tap.setpoints.clear()
        flight.signal(signal.SIGCONT, "link")
    flight.told("the link stood still", asked_t)
    flight.stays_uncoupled(2.0)
    assert flight.program.console.snapshot().status.armed


def test_a_link_whose_interpreter_is_held_for_8_s_lets_nothing_out(flight):
    """MAVSDK's own threads go on meanwhile, and have a setpoint to repeat."""
    held = flight.signal(signal.SIGUSR1, "link")
    assert lost_offboard(flight, held) < 1.2 + SLACK_S
    until(lambda: is_safe(flight.tap), 6, "the vehicle is safe by its own failsafe")
    assert max(t for t, _ in flight.tap.setpoints) - held < STALE_S + SLACK_S
    flight.tap.setpoints.clear()
    flight.see(lambda view: view.status.t > held + 7.0, 12, "the link goes on")
    flight.stays_uncoupled(1.5)


def test_a_pilot_whose_interpreter_is_held_for_8_s_lets_nothing_out(flight):
    held = flight.signal(signal.SIGUSR1, "pilot")
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    assert max(t for t, _ in flight.tap.setpoints) - held < STALE_S + SLACK_S
    flight.tap.setpoints.clear()
    flight.see(lambda view: view.pilot.t > held + 7.0, 12, "the pilot goes on")
    flight.stays_uncoupled(1.0)


# The hand


def test_a_silent_hand_ends_in_hold(flight):
    silent = time.monotonic()
    flight.hand.close()
    flight.uncoupled()
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    # A stick may be silent for 0.2 s before it counts as gone.
    assert last_moving(flight, silent) < stick.SILENCE_S + 0.1 + SLACK_S
    flight.end_program()


def test_releasing_by_the_handles_button_stops_the_vehicle_within_100_ms(flight):
    released = flight.hand.put((0.06, 0.0, 0.0), buttons=1 << 5)
    flight.uncoupled()
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    assert last_moving(flight, released) < 0.1
    flight.hand.put((0.06, 0.0, 0.0))
    flight.stays_uncoupled(0.5)


# Numbers that cannot be


def of_the_vehicle(bad: float, boot_ms: int) -> list[bytes]:
    """Return frames as of the vehicle at a time since its boot, each with a number that cannot be in one field."""
    link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    frames = []
    for field in range(6):
        numbers = [bad if at == field else 0.1 for at in range(6)]
        frames += [
            link.local_position_ned_encode(boot_ms, *numbers),
            link.attitude_encode(boot_ms, *numbers),
            link.vfr_hud_encode(*numbers[:2], 0, 0, *numbers[2:4]),
        ]
    return [bytes(frame.pack(link)) for frame in frames]


@pytest.mark.parametrize("bad", [math.nan, -math.inf, 1e30])
def test_numbers_that_cannot_be_from_the_vehicle_reach_neither_wire_nor_hand(flight, bad):
    began = time.monotonic()
    forces: list[float] = []
    for _ in range(10):
        boot_ms = [message.time_boot_ms for _, message in messages(flight.tap.heard[-60:], "ATTITUDE")][-1]
        for frame in of_the_vehicle(bad, boot_ms):
            flight.tap.say(frame)
        forces += flight.program.console.snapshot().handle.force
        time.sleep(0.02)
    flight.uncoupled()
    check_sane(flight, forces)
    flight.told("Disengaged", began)


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e30])
def test_numbers_that_cannot_be_from_the_device_reach_neither_wire_nor_hand(flight, bad):
    forces: list[float] = []
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as hand:
        for _ in range(10):
            for field in range(5):
                numbers = [bad if at == field else 0.01 for at in range(5)]
                numbers[0] = numbers[0] if field == 0 else time.monotonic()
                hand.sendto(stick.LAYOUT.pack(stick.MAGIC, stick.VERSION, *numbers, 0), flight.hand_socket)
            forces += flight.program.console.snapshot().handle.force
            time.sleep(0.02)
    check_sane(flight, forces)
    assert flight.tap.setpoints
    assert flight.program.console.snapshot().handle.present


def check_sane(flight, forces: list[float]) -> None:
    limits = flight.program.console.snapshot().device
    assert all(math.isfinite(each) for each in forces)
    assert max(map(abs, forces)) <= limits.force_limit
    for _, data in flight.tap.setpoints:
        velocity = asked(data)
        assert all(map(math.isfinite, velocity))
        assert math.hypot(*velocity[:2]) < 3.0 + 1e-3
        assert abs(velocity[2]) < 1.5 + 1e-3


# Clocks, disk, viewer


def test_a_wall_clock_that_jumps_an_hour_changes_nothing(flight, clocks):
    for jump in (HOUR_NS, -HOUR_NS, 0):
        shift(clocks, jump, 0)
        gaps = pace(flight, 1.0)
        assert max(gaps) < STALE_S
        assert flight.program.console.snapshot().pilot.phase == Phase.ENGAGED
    assert speed(flight.tap) > 0.5


def test_after_a_sleep_nothing_goes_on_by_itself_and_the_operator_engages_again(flight, clocks):
    """Shorter than any time-out, as the monotonic clock counts: only the other clock knows."""
    roles = ("screen", "recorder", "link", "pilot")
    stopped = flight.signal(signal.SIGSTOP, *roles)
    shift(clocks, 60 * 10**9, 60 * 10**9)
    flight.tap.setpoints.clear()
    time.sleep(0.05)
    woke = flight.signal(signal.SIGCONT, *reversed(roles))
    flight.told("his computer slept for 60.", stopped)
    flight.uncoupled()
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    assert max((t for t, _ in flight.tap.setpoints), default=woke) - woke < SLACK_S
    flight.stays_uncoupled(1.0)
    flight.hand.put((0.0, 0.0, 0.0))
    flight.engage()
    shift(clocks, 0, 60 * 10**9)


def test_a_viewer_that_hangs_and_a_disk_that_fills_change_nothing_in_flight_and_are_told(flight):
    began = time.monotonic()
    assert max(pace(flight, 1.0)) < STALE_S
    for role in ("recorder", "link"):
        pid = flight.program.pids()[role]
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (4096, 4096))
    flight.told("This flight is no longer recorded", began, 20)
    flight.told("MAVLink log", began)
    alarms = b"".join(
        each.text for each in flight.program.console.snapshot().events if each.severity == Severity.ALARM
    )
    assert b"no longer recorded" in alarms
    assert b"MAVLink log" in alarms
    assert max(pace(flight, 1.0)) < STALE_S
    assert flight.program.console.snapshot().pilot.phase == Phase.ENGAGED
    assert speed(flight.tap) > 0.5
    flight.end_program()


# Processes that die: each takes the program with it, so they come last


@pytest.mark.parametrize("role", ["recorder", "pilot", "link"])
def test_a_killed_process_ends_in_a_vehicle_that_is_safe_and_is_told(flight, role):
    program = flight.program
    killed, wall = flight.signal(signal.SIGKILL, role), time.time()
    if role == "link":
        assert lost_offboard(flight, killed) < 1.2 + SLACK_S
    until(lambda: is_safe(flight.tap), 6, "the vehicle is safe")
    assert max(t for t, _ in flight.tap.setpoints) - killed < STALE_S + SLACK_S
    flight.told(f"The {role} process has died", killed)
    if role != "pilot":
        view = flight.uncoupled()
        assert math.hypot(*view.handle.force) == 0.0
    program.process.send_signal(signal.SIGTERM)
    program.process.wait(30)
    assert not descendants(program.process.pid)
    assert not left_behind(program.process.pid)
    if role != "pilot":
        # What the pilot no longer publishes nobody can record.
        assert recorded_until(flight.logs) > wall - 1.0
    assert logged_until(flight.logs) > wall - 1.0
    flight.end_program()


def recorded_until(logs: Path) -> float:
    """Return until when the newest recording has handles, s since 1970."""
    flight = Flight(max(logs.glob("*.rrd"), key=os.path.getmtime))
    began = datetime.datetime.fromisoformat(str(flight.properties()["started"])).timestamp()
    return began + float(flight.series(schema.HANDLE_FORCE).t[-1])


def logged_until(logs: Path) -> float:
    """Return until when the newest MAVLink log has frames, s since 1970."""
    log = mavutil.mavlink_connection(str(max(logs.glob("*.tlog"), key=os.path.getmtime)))
    last = 0.0
    while (message := log.recv_match()) is not None:
        last = message._timestamp
    log.close()
    return last


def test_a_killed_screen_takes_all_with_it_and_the_vehicle_holds(flight):
    program, pids = flight.program, flight.program.pids()
    os.kill(program.process.pid, signal.SIGKILL)
    program.process.wait(10)
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    until(lambda: all(map(gone, pids.values())), 20, "the others end")
    assert not left_behind(program.process.pid)
    until(lambda: b"\x1b[?1049l" in program.screen, 5, "the terminal is given back")
    flight.end_program()


def test_a_terminal_that_goes_takes_all_with_it_and_the_vehicle_holds(flight):
    program, pids = flight.program, flight.program.pids()
    assert set(pids) == OURS
    program.hang_up()
    program.process.wait(20)
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    until(lambda: all(map(gone, pids.values())), 20, "the others end")
    assert not left_behind(program.process.pid)
    flight.end_program()
