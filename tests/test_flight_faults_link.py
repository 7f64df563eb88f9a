"""Faults of the way to the vehicle and of the vehicle itself, done to a flight that is coupled.

The vehicle's side shows what became of each. Faults on this side: `test_flight_faults.py`.
"""

import math
import os
import pty
import time
from pathlib import Path

import pytest
from flight_support import (
    PX4_AUTO,
    PX4_LAND,
    PX4_LOITER,
    Stage,
    another_station,
    asked,
    hears,
    holds,
    is_safe,
    messages,
    set_parameters,
    until,
)

from bench.radio import Radio
from bench.rig import SETPOINT_ID
from groundstation.messages import CommandKind, FlightMode, Health, Phase

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]

# What a shared machine may add to a time that is measured from outside.
SLACK_S = 0.05
IDEAL = {"DELAY": 0.0, "JITTER": 0.0, "LOSS": 0.0, "REORD": 0.0, "DUP": 0.0}


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    # A device that renders the force: what a poor link does to it is felt.
    it = Stage(tmp_path_factory.mktemp("faults"), device="emulated:falcon@", push=0.03)
    yield it
    it.close()


@pytest.fixture
def flight(stage):
    return stage.coupled()


def refused(stage, kind: CommandKind, words: str, shown: bytes) -> float:
    """Give a command that is refused, see why on the screen, and return after how long, s.

    The banner has the last of the reason, and the events as much of it as there is room for.
    """
    until(lambda: b"LINK" in stage.program.screen, 20.0, "the screen is there")
    stage.program.screen.clear()
    given = time.monotonic()
    stage.program.console.command(kind)
    stage.told(words, given, 3.0)
    until(lambda: shown in stage.program.screen, 3.0, f"the screen shows: {shown}")
    return time.monotonic() - given


def test_arming_that_is_denied_is_explained_within_a_second(stage):
    program = stage.ready
    program.until(lambda view: hears(view) and view.status.health, 40, "heard")
    set_parameters(stage.tap, COM_ARM_MIS_REQ=1)
    values = lambda: (said.param_id for _, said in messages(stage.tap.heard[-100:], "PARAM_VALUE"))  # noqa: E731
    until(lambda: "COM_ARM_MIS_REQ" in values(), 5, "the parameter is set")
    try:
        assert refused(stage, CommandKind.ARM, "a mission is required", b"mission is") < 1.0
        assert not program.console.snapshot().status.armed
    finally:
        set_parameters(stage.tap, COM_ARM_MIS_REQ=0)


def test_a_vehicle_that_is_left_in_land_is_armed_by_way_of_hold(stage):
    """PX4 from 1.14 on goes to Hold when it has landed, and others stay: there nothing is armed."""
    program = stage.ready
    program.until(lambda view: hears(view) and view.status.health, 40, "heard")
    other = another_station()
    land = other.command_long_encode(1, 1, 176, 0, 1 | 128, PX4_AUTO, PX4_LAND, 0, 0, 0, 0)
    stage.tap.inject(bytes(land.pack(other)))
    program.until(lambda view: view.status.mode == FlightMode.LAND, 5, "it is in Land")
    program.until(lambda view: not view.status.health & Health.ARMABLE, 5, "it cannot be armed there")
    program.console.command(CommandKind.ARM)
    program.until(lambda view: view.status.armed, 5, "it is armed")
    program.console.command(CommandKind.DISARM)
    program.until(lambda view: not view.status.armed, 5, "it is disarmed")


def test_a_mode_that_is_denied_is_explained_within_a_second_and_nothing_is_coupled(flight):
    flight.hand.put((0.0, 0.0, 0.0))
    flight.act(CommandKind.HOLD, lambda view: view.pilot.phase == Phase.DISENGAGED, "released")
    until(lambda: holds(flight.tap), 6, "the vehicle holds")
    # The vehicle hears no setpoint, and denies Offboard for that.
    flight.tap.passes = lambda data: not (data[0] == 0xFD and data[7] == SETPOINT_ID)
    flight.program.screen.clear()
    began = time.monotonic()
    flight.program.console.command(CommandKind.ENGAGE)
    denied = until(
        lambda: next((t for t, said in messages(flight.tap.heard[-100:], "STATUSTEXT") if t > began), 0.0),
        5,
        "the vehicle denies it",
    )
    assert flight.told("no setpoints are coming", began) - denied < 1.0
    # A line among the events, or the last lines of it, as much as there is room for.
    why = (b"Offboard denied", b"setpoints are coming")
    until(lambda: any(words in flight.program.screen for words in why), 2, "the screen shows why")
    assert time.monotonic() - denied < 1.0
    flight.uncoupled()
    flight.mend()
    flight.stays_uncoupled(1.0)


def test_another_that_takes_over_is_shown_within_1500_ms_and_not_fought(flight):
    # A second ground station asks the vehicle to hold, straight at its socket.
    other = another_station()
    hold = other.command_long_encode(1, 1, 176, 0, 1 | 128, PX4_AUTO, PX4_LOITER, 0, 0, 0, 0)
    flight.program.screen.clear()
    taken = time.monotonic()
    flight.tap.inject(bytes(hold.pack(other)))
    until(lambda: b"by another" in flight.program.screen, 5, "the screen shows it")
    assert time.monotonic() - taken < 1.5
    flight.uncoupled(1.0)
    time.sleep(0.3)
    flight.stays_uncoupled(1.5)
    assert holds(flight.tap)


def asked_speed(flight, since: float) -> float:
    """Return the largest speed around that left since a moment, m/s."""
    return max((math.hypot(*asked(data)[:2]) for t, data in flight.tap.setpoints if t > since), default=0.0)


def test_a_speed_limit_that_another_station_lowers_in_flight_is_kept_at_once(flight):
    until(lambda: asked_speed(flight, 0.0) > 0.6, 5, "it is flown fast")
    lowered = time.monotonic()
    set_parameters(flight.tap, MPC_XY_VEL_MAX=0.5)
    try:
        told = flight.told("MPC_XY_VEL_MAX is 0.5 now, was 12", lowered)
        flight.uncoupled(1.0)
        assert told - lowered < 0.5
        until(lambda: holds(flight.tap), 6, "the vehicle holds")
        assert last_faster(flight, lowered, 0.5) < 0.5
        flight.hand.put((0.0, 0.0, 0.0))
        flight.engage()
        flight.hand.put((0.03, 0.0, 0.0))
        flight.tap.setpoints.clear()
        until(lambda: asked_speed(flight, 0.0) > 0.1, 5, "it is flown again")
        time.sleep(1.0)
        assert asked_speed(flight, 0.0) <= 0.5 + 1e-3
    finally:
        set_parameters(flight.tap, MPC_XY_VEL_MAX=12.0)
        flight.told("MPC_XY_VEL_MAX is 12 now, was 0.5", lowered)


def last_faster(flight, since: float, speed: float) -> float:
    """Return how long after a moment the last setpoint left that asks for more than a speed, s."""
    return max(
        (t - since for t, data in flight.tap.setpoints if math.hypot(*asked(data)[:2]) > speed + 1e-3),
        default=0.0,
    )


def test_a_failsafe_that_another_station_disarms_while_the_link_is_down_is_read_when_it_is_back(flight):
    """What is told while nobody hears it is lost: it is asked for."""
    cut = flight.cut()
    flight.uncoupled(3.0)
    set_parameters(flight.tap, COM_OBL_RC_ACT=7)
    time.sleep(0.2)
    try:
        mended = flight.mend()
        assert flight.told("COM_OBL_RC_ACT is 7 now, was 0: Disarm", mended) > cut
        flight.see(lambda view: b"COM_OBL_RC_ACT = 7" in view.status.unsafe, 1.0, "called unsafe")
        flight.hand.put((0.0, 0.0, 0.0))
        flight.program.console.command(CommandKind.ENGAGE)
        flight.told("Engage refused: COM_OBL_RC_ACT = 7", mended)
    finally:
        set_parameters(flight.tap, COM_OBL_RC_ACT=0)
        flight.told("COM_OBL_RC_ACT is 0 now, was 7", cut)


@pytest.mark.parametrize("seconds", [0.5, 2.0, 5.0, 30.0])
def test_a_link_that_is_cut_is_told_takes_the_force_and_does_not_resume_by_itself(flight, seconds):
    cut = flight.cut()
    # What is told at half a second is true only of a cut that lasts as long.
    assert flight.told("The vehicle is silent", cut, 2.0) - cut < 0.5 + SLACK_S
    time.sleep(max(0.0, cut + seconds - time.monotonic()))
    if seconds > 1.0:
        view = flight.uncoupled(1.0)
        assert math.hypot(*view.handle.force) == 0.0
        until(lambda: is_safe(flight.tap), 3, "the vehicle is safe by its own failsafe")
    coupled = flight.program.console.snapshot().pilot.phase
    mended = flight.mend()
    flight.told("The vehicle is heard again", mended)
    if coupled == Phase.DISENGAGED:
        flight.stays_uncoupled(1.5)


@pytest.mark.parametrize(
    ("conditions", "stays"),
    [
        ({"DELAY": 0.025, "JITTER": 0.01, "LOSS": 0.01, "REORD": 0.1, "DUP": 0.1}, True),
        ({"DELAY": 0.025, "JITTER": 0.05, "LOSS": 0.3, "REORD": 0.3, "DUP": 0.3}, False),
        ({"DELAY": 0.15, "JITTER": 0.05, "LOSS": 0.1, "REORD": 0.2, "DUP": 0.2}, True),
        ({"DELAY": 0.35, "JITTER": 0.1, "LOSS": 0.01, "REORD": 0.1, "DUP": 0.1}, False),
        ({"DELAY": 0.35, "JITTER": 0.1, "LOSS": 0.3, "REORD": 0.3, "DUP": 0.3}, False),
    ],
)
def test_a_poor_link_leaves_the_force_bounded_and_passive_and_the_speed_capped(flight, conditions, stays):
    limit = flight.program.console.snapshot().device.force_limit
    apply(flight, conditions)
    try:
        began = time.monotonic()
        since = len(flight.tap.heard)
        flight.tap.setpoints.clear()
        while (t := time.monotonic() - began) < 4.0:
            flight.hand.put((0.03 * math.cos(2.0 * t), 0.03 * math.sin(2.0 * t), 0.0))
            view = flight.program.console.snapshot()
            assert math.hypot(*view.handle.force) <= limit
            # What the hand has given and not been given back: the port gives no net energy.
            assert view.pilot.port_energy > -1e-3
            time.sleep(0.02)
        assert stays <= (view.pilot.phase == Phase.ENGAGED), view.pilot.reason
        flown = [message for _, message in messages(flight.tap.heard[since:], "LOCAL_POSITION_NED")]
        assert max(math.hypot(message.vx, message.vy) for message in flown) < 3.0 * 1.1
        assert all(math.hypot(*asked(data)[:2]) < 3.0 + 1e-3 for _, data in flight.tap.setpoints)
    finally:
        # What sets them goes through the channel, too.
        for _ in range(20):
            apply(flight, IDEAL)
            time.sleep(0.05)


def apply(flight, conditions) -> None:
    set_parameters(
        flight.tap,
        **{f"SIM_{way}_{name}": value for way in ("UP", "DN") for name, value in conditions.items()},
    )


def test_a_vehicle_that_reboots_in_flight_is_disarmed_and_not_coupled(flight):
    pids = flight.program.pids()
    rebooted = time.monotonic()
    flight.start_vehicle()
    flight.told("The vehicle has rebooted", rebooted, 15)
    view = flight.see(
        lambda view: hears(view) and not view.status.armed and not view.status.in_air, 10, "disarmed"
    )
    assert view.pilot.phase == Phase.DISENGAGED
    flight.stays_uncoupled(2.0)
    # Everything is read anew, and flown with again by the same processes.
    assert flight.coupled().program.pids() == pids


def share_of_a_core(pid: int, seconds: float) -> float:
    def used() -> float:
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    before = used()
    time.sleep(seconds)
    return (used() - before) / seconds


def test_a_serial_port_that_is_unplugged_comes_back_under_another_number(stage, tmp_path):
    stage.end_program()
    stage.start_vehicle()
    radio = Radio(tmp_path / "port", stage.tap.program_port)
    stage.url = f"serial://{radio.name}:57600"
    try:
        flight = stage.coupled()
        first = radio.name.readlink()
        unplugged = radio.unplug()
        assert flight.told("is gone; plug it in again", unplugged) - unplugged < 1.0
        others = pty.openpty()
        flight.uncoupled(2.0)
        until(lambda: is_safe(flight.tap), 6, "the vehicle is safe by its own failsafe")
        share = share_of_a_core(flight.program.pids()["link"], 2.0)
        plugged = time.monotonic()
        radio.plug()
        assert radio.name.readlink() != first
        flight.told("is back", plugged)
        flight.see(hears, 5.0 - (time.monotonic() - plugged), "heard again within 5 s")
        print(f"without its port the link takes {share:.1%} of a core")
        assert share < 0.05
        flight.stays_uncoupled(1.0)
        flight.coupled()
        for other in others:
            os.close(other)
    finally:
        stage.end_program()
        radio.close()
