"""The servo with a real device driver and a real bus, tick by tick in virtual time; and once as a process."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from math import hypot, nan, radians
from pathlib import Path

import pytest
from servo_bench import Bench, World, make_run

from groundstation.config import Settings
from groundstation.messages import (
    DEVICE_REPORT,
    HEARTBEAT,
    SERVO_REPORT,
    CommandKind,
    Cue,
    FlightMode,
    MappingMode,
    Phase,
    Preset,
    Severity,
    Stream,
)
from groundstation.pilot.lateness import Lateness
from groundstation.run import write_run
from groundstation.run_folder import new_run_id, sweep


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path)
    yield bench
    bench.close()


def test_engaging_streams_zero_until_the_vehicle_confirms_then_follows_the_hand(bench: Bench) -> None:
    bench.run(1.2)
    number = bench.world.command(CommandKind.ENGAGE, bench.now)
    list(bench.world.setpoints.drain())
    bench.run(0.5)
    answer = bench.world.answers.newest()
    assert answer is not None
    assert (answer.number, answer.kind, answer.ok) == (number, CommandKind.ENGAGE, 1)
    assert bench.phase() is Phase.ENGAGING
    bench.stick = (0.1, 0.0, 0.0)
    bench.run(0.5)
    waiting = list(bench.world.setpoints.drain())
    assert len(waiting) in {50, 51}
    assert all(setpoint.active and tuple(setpoint.velocity) == (0.0,) * 4 for setpoint in waiting)
    bench.world.confirm()
    bench.run(1.0)
    assert bench.phase() is Phase.ENGAGED
    flown = list(bench.world.setpoints.drain())
    assert flown[-1].velocity[0] > 1.0
    assert flown[-1].number - flown[0].number == len(flown) - 1
    assert bench.now - flown[-1].handle_t < 0.05
    # The vehicle stands still, so p_h runs ahead of it and the hand is pushed back.
    assert bench.device.force[0] < -1.0
    handle = bench.world.handles.newest()
    assert handle is not None
    assert tuple(handle.force) == bench.device.force
    assert (Severity.INFO, "Engaged: the vehicle follows the hand.") in bench.said()


def test_an_act_that_is_refused_says_why(bench: Bench) -> None:
    bench.stick = (0.05, 0.0, 0.0)
    bench.run(1.2)
    for change, words in (({"armed": 0}, "not armed"), ({"armed": 1}, "centre")):
        for name, value in change.items():
            setattr(bench.world.status, name, value)
        bench.run(0.05)
        bench.world.command(CommandKind.ENGAGE, bench.now)
        bench.run(0.05)
        answer = bench.world.answers.newest()
        assert answer is not None
        assert not answer.ok
        assert answer.text.decode().startswith("Engage refused: ")
        assert words in answer.text.decode()
        state = bench.world.pilots.newest()
        assert state is not None
        assert words in state.reason.decode()
        assert bench.phase() is Phase.DISENGAGED


@pytest.mark.parametrize(
    "kind",
    [
        CommandKind.DISENGAGE,
        CommandKind.HOLD,
        CommandKind.LAND,
        CommandKind.RETURN,
        CommandKind.DISARM,
        CommandKind.KILL,
    ],
)
def test_every_act_that_steers_otherwise_lets_go_and_only_disengage_is_answered(
    bench: Bench, kind: CommandKind
) -> None:
    bench.engage()
    list(bench.world.answers.drain())
    bench.world.command(kind, bench.now)
    bench.run(0.002)
    setpoint = bench.world.setpoints.newest()
    assert setpoint is not None
    assert not setpoint.active
    assert tuple(setpoint.velocity) == (0.0,) * 4
    assert [answer.kind for answer in bench.world.answers.drain()] == [kind] * (kind is CommandKind.DISENGAGE)
    assert [severity for severity, _ in bench.said()] == [Severity.INFO]


def lose_stick(bench: Bench) -> None:
    bench.stick = None


def lose_vehicle(bench: Bench) -> None:
    bench.vehicle = False


def take_away(bench: Bench) -> None:
    bench.world.confirm(FlightMode.POSITION)


def land(bench: Bench) -> None:
    bench.world.status.in_air = 0


def disarm(bench: Bench) -> None:
    bench.world.status.armed = 0


def reboot(bench: Bench) -> None:
    bench.world.state.boot_t = 0.5


def spoil(bench: Bench) -> None:
    bench.world.state.velocity[1] = nan


def distrust(bench: Bench) -> None:
    bench.world.state.valid = 0


def stall(bench: Bench) -> None:
    bench.now += 0.2
    bench.world.say(bench.now)
    bench.world.stick.send((0.0, 0.0, 0.0), 0.0, 0, bench.now)


def end_stream(bench: Bench) -> None:
    bench.world.confirm(stream=Stream.ENDED)


@pytest.mark.parametrize(
    ("fault", "words", "within"),
    [
        (lose_stick, "handle's sample is 0.10 s old", 0.11),
        (lose_vehicle, "position is 0.5 s old", 0.55),
        (take_away, "went to POSITION", 0.05),
        (land, "on the ground", 0.05),
        (disarm, "not armed", 0.05),
        (reboot, "rebooted", 0.05),
        (spoil, "number", 0.05),
        (distrust, "trust", 0.05),
        (stall, "servo stood still for 0.20 s", 0.05),
        (end_stream, "link stopped", 0.05),
    ],
)
def test_every_fault_ends_in_no_force_no_setpoint_and_words(
    bench: Bench, fault: object, words: str, within: float
) -> None:
    bench.engage()
    bench.stick = (0.1, 0.0, 0.0)
    bench.run(1.0)
    assert hypot(*bench.device.force) > 1.0
    fault(bench)
    bench.run(within)
    setpoint = bench.world.setpoints.newest()
    assert setpoint is not None
    assert not setpoint.active
    assert tuple(setpoint.velocity) == (0.0,) * 4
    assert [said for said in bench.said() if said[0] is Severity.ALARM and words in said[1]]
    bench.run(0.1)
    assert bench.device.force == (0.0, 0.0, 0.0)
    # What comes back does not engage by itself.
    bench.stick, bench.vehicle = (0.0, 0.0, 0.0), True
    bench.world.state.velocity[1] = 0.0
    bench.world.state.valid = bench.world.status.armed = bench.world.status.in_air = 1
    bench.world.confirm()
    bench.run(1.5)
    assert bench.phase() is Phase.DISENGAGED
    assert not any(later.active for later in bench.world.setpoints.drain())


def test_a_device_that_is_lost_has_not_moved_and_so_has_given_and_taken_nothing(bench: Bench) -> None:
    """Read as if it were in its centre it had moved there at once, against the force that was held."""
    bench.engage()
    bench.stick = (0.05, 0.0, 0.0)
    bench.run(0.6)
    before = bench.world.pilots.newest()
    assert before is not None
    assert hypot(*bench.device.force) > 0.5
    lose_stick(bench)
    bench.run(0.6)
    after, handle = bench.world.pilots.newest(), bench.world.handles.newest()
    assert after is not None
    assert handle is not None
    assert after.phase == Phase.DISENGAGED
    assert after.port_energy == pytest.approx(before.port_energy, abs=1e-6)
    assert (handle.present, tuple(handle.position), tuple(handle.force)) == (0, (0.05, 0.0, 0.0), (0.0,) * 3)


def test_nothing_that_is_not_a_number_reaches_the_bus(bench: Bench) -> None:
    bench.engage()
    bench.world.state.position[0] = nan
    bench.run(0.1)
    state = bench.world.pilots.newest()
    assert state is not None
    for numbers in (state.p_h, state.p_h_rate, state.error, state.v_ref, state.force):
        assert all(number == number for number in numbers)
    assert state.state_age > 0.05


def test_choices_are_commands_that_are_answered_and_shown(bench: Bench) -> None:
    bench.engage()
    for kind, value in (
        (CommandKind.MAPPING, MappingMode.POSITION),
        (CommandKind.FINE, 1),
        (CommandKind.CLUTCH, 1),
        (CommandKind.PRESET, Preset.TRAINING),
        (CommandKind.CUES, Cue.POSITION | Cue.DAMPING),
    ):
        number = bench.world.command(kind, bench.now, value)
        bench.run(0.05)
        answer = list(bench.world.answers.drain())[-1]
        assert (answer.number, answer.kind, bool(answer.ok)) == (number, kind, True)
    state = bench.world.pilots.newest()
    assert (state.mapping, state.preset, state.cues) == (MappingMode.POSITION, Preset.TRAINING, 17)
    assert (state.fine, state.clutched) == (1, 1)
    assert bench.phase() is Phase.ENGAGED
    bench.world.command(CommandKind.PRESET, bench.now, 9)
    bench.run(0.05)
    refused = list(bench.world.answers.drain())[-1]
    assert not refused.ok
    assert refused.text == b"there is no preset 9"


def test_the_handle_s_buttons_clutch_and_switch(bench: Bench) -> None:
    bench.engage()
    bench.buttons = 0b10001
    bench.run(0.1)
    state = bench.world.pilots.newest()
    assert (state.clutched, state.mapping) == (1, MappingMode.POSITION)
    bench.buttons = 0
    bench.run(0.1)
    state = bench.world.pilots.newest()
    assert (state.clutched, state.mapping) == (0, MappingMode.POSITION)


def test_gains_margin_and_forecast_are_published_as_the_measured_round_trip_has_them(bench: Bench) -> None:
    bench.world.status.rtt = 0.7
    bench.engage()
    bench.stick = (0.05, 0.0, 0.0)
    bench.run(0.5)
    state = bench.world.pilots.newest()
    assert state.delay == pytest.approx(0.7)
    assert state.k1[0] < Settings().control.k1[0]
    assert state.phase_margin == pytest.approx(radians(45), abs=1e-3)
    assert state.speed_share < 1.0
    # The model flies on what has been sent, while this vehicle stands.
    assert state.predicted[0] > 1.0
    assert state.stop[0] > state.predicted[0]


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("rtt", 1.5, "the round trip of 1.5 s is too long"),
        ("loss", 0.9, "90% of the vehicle's frames are lost"),
    ],
)
def test_too_poor_a_link_lets_go_and_does_not_couple_again(
    bench: Bench, field: str, value: float, words: str
) -> None:
    bench.engage()
    setattr(bench.world.status, field, value)
    bench.run(0.1)
    assert bench.phase() is Phase.DISENGAGED
    assert any(words in text for _, text in bench.said())
    setattr(bench.world.status, field, 0.05)
    bench.run(0.5)
    assert bench.phase() is Phase.DISENGAGED


FAILING = """
class Fails:
    def __init__(self, settings): ...
    def start(self): return 0
    def step(self, state, view):
        if state == 300:
            raise ZeroDivisionError("by nothing")
        from groundstation.pilot.controller import Law
        return state + 1, Law((0.5, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
"""


def test_a_controller_that_fails_in_flight_ends_in_a_hold_and_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "failing_in_flight.py").write_text(FAILING)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    bench = Bench(tmp_path, "failing_in_flight:Fails")
    try:
        bench.engage()
        bench.run(0.1)
        flying = bench.world.setpoints.newest()
        assert flying.active
        assert flying.velocity[0] > 0.1
        bench.run(0.5)
        assert bench.phase() is Phase.DISENGAGED
        assert not bench.world.setpoints.newest().active
        assert list(bench.world.setpoints.newest().velocity) == [0.0] * 4
        assert list(bench.world.handles.newest().force) == [0.0] * 3
        said = "Disengaged: the controller failing_in_flight:Fails failed (ZeroDivisionError: by nothing)."
        assert (Severity.ALARM, said) in bench.said()
    finally:
        bench.close()


def test_the_reports_tell_device_and_timing_and_the_idle_setpoint_is_inactive(bench: Bench) -> None:
    devices = bench.world.bus.subscriber(DEVICE_REPORT)
    servos = bench.world.bus.subscriber(SERVO_REPORT)
    late = Lateness(100)
    bench.run(1.2)
    late.add(0.002)
    bench.servo.report(bench.now, late, 7, realtime=True)
    device, servo, setpoint = devices.newest(), servos.newest(), bench.world.setpoints.newest()
    assert device is not None
    assert servo is not None
    assert setpoint is not None
    assert (device.name, device.renders, device.present, device.homed) == (
        b"On-screen stick",
        b"nothing",
        1,
        1,
    )
    assert (device.workspace, device.force_limit) == (0.1, 10.0)
    assert (servo.rate, servo.late_max, servo.ticks, servo.missed, servo.realtime) == (
        1000.0,
        0.002,
        1200,
        7,
        1,
    )
    assert not setpoint.active
    bench.servo.report(bench.now + 0.3, late, 7, realtime=True)
    assert servos.newest() is servo


@pytest.fixture
def process(tmp_path: Path) -> Iterator[tuple[World, subprocess.Popen[bytes]]]:
    run_id, socket = new_run_id(), str(tmp_path / "hand.sock")
    path = write_run(make_run(run_id, f"virtual:{socket}"))
    world = World(run_id, socket)
    popen = subprocess.Popen(
        [sys.executable, "-m", "groundstation.pilot.servo", str(path)], stderr=subprocess.PIPE
    )
    yield world, popen
    popen.kill()
    popen.communicate()
    world.close()
    sweep(run_id)


def keep_going(world: World, until: object, seconds: float = 20.0) -> bool:
    """Be link and hand in real time until something is so."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        now = time.monotonic()
        world.stick.send((0.0, 0.0, 0.0), 0.0, 0, now)
        world.say(now)
        if until():
            return True
        time.sleep(0.01)
    return False


def engaged(world: World, phase: Phase) -> bool:
    state = world.pilots.newest()
    return state is not None and state.phase == phase


@pytest.mark.flight
def test_the_process_engages_streams_and_ends_cleanly_on_sigterm(
    process: tuple[World, subprocess.Popen[bytes]],
) -> None:
    world, popen = process
    beats = world.bus.subscriber(HEARTBEAT)
    servos = world.bus.subscriber(SERVO_REPORT)
    centred = lambda: (state := world.pilots.newest()) is not None and bool(state.centred)  # noqa: E731
    assert keep_going(world, centred), popen.stderr
    world.command(CommandKind.ENGAGE, time.monotonic())
    assert keep_going(world, lambda: engaged(world, Phase.ENGAGING))
    world.confirm()
    assert keep_going(world, lambda: engaged(world, Phase.ENGAGED))
    list(world.setpoints.drain())
    seen: list = []
    assert keep_going(world, lambda: seen.extend(world.setpoints.drain()) or len(seen) >= 20)
    assert all(setpoint.active for setpoint in seen)
    assert {(beat.role, beat.pid) for beat in beats.drain()} == {(b"pilot", popen.pid)}
    assert keep_going(world, lambda: (report := servos.newest()) is not None and report.ticks > 100)
    popen.send_signal(signal.SIGTERM)
    assert popen.wait(10) == 0, popen.stderr
    last = list(world.setpoints.drain())[-1]
    assert not last.active
    assert tuple(last.velocity) == (0.0,) * 4
    with pytest.raises(ProcessLookupError):
        os.kill(popen.pid, 0)


@pytest.mark.flight
def test_an_unknown_device_ends_the_process_with_a_sentence(tmp_path: Path) -> None:
    run_id = new_run_id()
    path = write_run(make_run(run_id, "no-such-device:1"))
    try:
        ended = subprocess.run(
            [sys.executable, "-m", "groundstation.pilot.servo", str(path)],
            check=False,
            capture_output=True,
            timeout=30,
        )
        assert ended.returncode == 1
        assert ended.stderr.decode().strip().count("\n") == 0
        assert "no such haptic device" in ended.stderr.decode()
    finally:
        sweep(run_id)
