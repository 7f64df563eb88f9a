"""The 2DIY: linkage, bytes, and the driver against its emulator over a real pty, in virtual time."""

from __future__ import annotations

import contextlib
import math
import struct
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3, DeviceError
from drivers.emulators.faults import Faults
from drivers.emulators.hand import EmulatedHand, Intention, circle
from drivers.emulators.two_diy import TwoDiyEmulator
from drivers.registry import make_device
from drivers.stick import StickSender
from drivers.two_diy import driver, wire
from drivers.two_diy.driver import CENTRE, WORKSPACE, TwoDiy
from drivers.two_diy.kinematics import BASE, CRANK, FOREARM, forward, inverse, jacobian, torques

TICK = 1e-3
places = st.builds(
    lambda angle, radius: (CENTRE[0] + radius * math.cos(angle), CENTRE[1] + radius * math.sin(angle)),
    st.floats(0, math.tau),
    st.floats(0, WORKSPACE),
)


class Clock:
    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


class Rig:
    """A 2DIY, its emulator, and one clock; each tick the servo reads and writes, then the board answers."""

    def __init__(self, motion=lambda t: Intention()) -> None:
        self.clock = Clock()
        self.emulator = TwoDiyEmulator(EmulatedHand(WORKSPACE, self.clock, motion=motion), self.clock)
        _, _, path = self.emulator.uri.partition(":")
        self.device = TwoDiy(path, self.clock, self.pause)

    def pause(self, seconds):
        self.clock.now += seconds
        self.emulator.turn()

    def tick(self, force=ZERO3):
        self.clock.now += TICK
        self.emulator.turn()
        state = self.device.read()
        self.device.write_force(force)
        return state

    def start(self):
        self.device.open()
        for _ in range(3):
            try:
                self.tick()
            except DeviceError:
                self.device.write_force(ZERO3)

    def run(self, seconds, force=ZERO3):
        return [self.tick(force) for _ in range(round(seconds / TICK))]


@pytest.fixture
def rig():
    rig = Rig()
    rig.start()
    yield rig
    rig.device.close()
    rig.emulator.close()


# The linkage


@given(places)
def test_forward_of_inverse_is_the_same_place(place):
    thetas = inverse(*place)
    assert thetas is not None
    assert math.dist(forward(*thetas), place) <= 1e-6


@given(places)
def test_the_links_keep_their_lengths(place):
    """Independent of how the two were derived: every link is as long as it is built."""
    theta1, theta2 = inverse(*place)
    elbow1 = (CRANK * math.cos(theta1), CRANK * math.sin(theta1))
    elbow2 = (BASE + CRANK * math.cos(theta2), CRANK * math.sin(theta2))
    assert math.dist(elbow1, place) == pytest.approx(FOREARM, abs=1e-12)
    assert math.dist(elbow2, place) == pytest.approx(FOREARM, abs=1e-12)
    assert elbow1[0] < elbow2[0]


@given(places)
def test_the_jacobian_is_the_slope_of_forward(place):
    theta1, theta2 = inverse(*place)
    (xx, xy), (yx, yy) = jacobian(theta1, theta2)
    h = 1e-5
    for column, (d1, d2) in (((xx, yx), (h, 0.0)), ((xy, yy), (0.0, h))):
        ahead, behind = forward(theta1 + d1, theta2 + d2), forward(theta1 - d1, theta2 - d2)
        slope = tuple((a - b) / (2 * h) for a, b in zip(ahead, behind, strict=True))
        assert math.dist(column, slope) <= 1e-4 * math.hypot(*slope)


@given(places, st.floats(-3, 3), st.floats(-3, 3), st.floats(-1, 1), st.floats(-1, 1))
def test_torques_do_the_work_of_the_force(place, fx, fy, rate1, rate2):
    theta1, theta2 = inverse(*place)
    (xx, xy), (yx, yy) = jacobian(theta1, theta2)
    tau1, tau2 = torques(theta1, theta2, (fx, fy))
    power = fx * (xx * rate1 + xy * rate2) + fy * (yx * rate1 + yy * rate2)
    assert tau1 * rate1 + tau2 * rate2 == pytest.approx(power, abs=1e-12)


@given(st.floats(-10, 10), st.floats(-10, 10))
def test_no_angles_break_the_kinematics(theta1, theta2):
    place = forward(theta1, theta2)
    assert place is None or all(map(math.isfinite, place))
    assert all(map(math.isfinite, torques(theta1, theta2, (3.0, -3.0))))


def test_where_the_arms_do_not_reach_there_is_no_angle():
    assert inverse(0.2, 0.2) is None
    assert inverse(0.0, 0.0) is None
    assert forward(math.pi, 0.0) == pytest.approx((0.019, math.sqrt(FOREARM**2 - 0.089**2)))
    assert jacobian(math.pi / 2, math.pi / 2 + 1e9 * math.tau) is not None


# The bytes


def test_the_packets_are_those_of_the_makers_own_program():
    """Bytes that HaplyHAPI 1.0.1 sends with the encoders and motors of a version 3 device."""
    assert bytes.fromhex("0000") == wire.RESET
    assert wire.setup() == bytes.fromhex("01 05 03 01 01 03 01 01 00 00 00004041 00809845 00002843 00809845")
    assert wire.drive(0.125, -0.5) == bytes.fromhex("02 05 000000bf 0000003e")
    assert wire.angles(bytes.fromhex("05 00004041 00002843")) == pytest.approx(wire.HOME)


@given(st.floats(-360, 360, width=32), st.floats(-360, 360, width=32))
def test_angles_survive_the_wire(first, second):
    thetas = wire.angles(struct.pack("<Bff", 5, second, first))
    assert thetas == pytest.approx((math.radians(first), math.radians(second)))


@given(st.binary(max_size=20))
def test_no_bytes_give_an_angle_that_is_not_one(reply):
    thetas = wire.angles(reply)
    assert thetas is None or (len(reply) == 9 and all(abs(theta) <= math.tau for theta in thetas))


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e30, 100000.0])
@pytest.mark.parametrize("place", [0, 1])
def test_angles_that_are_none_are_refused(bad, place):
    degrees = [168.0, 12.0]
    degrees[place] = bad
    assert wire.angles(struct.pack("<Bff", 5, *degrees)) is None


# The driver


def test_it_reads_where_the_hand_goes():
    rig = Rig(motion=lambda t: Intention((0.03, -0.02, 0.0)))
    rig.start()
    state = rig.run(1.5)[-1]
    assert state.position == pytest.approx((0.03, -0.02, 0.0), abs=driver.COUNT)
    assert state.velocity == pytest.approx(ZERO3, abs=0.01)
    assert state.homed
    assert state.buttons == 0
    assert rig.clock.now - state.device_time <= 1.001 * TICK
    assert rig.device.refused == 0
    rig.emulator.close()
    rig.device.close()


def test_it_knows_its_speed():
    rig = Rig(motion=circle(0.03, 2.0))
    rig.start()
    states = rig.run(6.0)
    for before, state, after in zip(states[3000:], states[3020:], states[3040:], strict=False):
        slope = [(b - a) / (40 * TICK) for a, b in zip(before.position, after.position, strict=True)]
        assert math.dist(state.velocity, slope) <= 0.01
    rig.emulator.close()
    rig.device.close()


def test_a_force_reaches_the_hand_as_it_is_meant(rig):
    state = rig.run(1.5, force=(1.35, -0.675, 9.0))[-1]
    assert rig.emulator.force == pytest.approx((1.35, -0.675, 0.0), abs=0.02)
    assert state.position == pytest.approx((0.01, -0.005, 0.0), abs=driver.COUNT)


def test_a_large_force_is_limited_and_keeps_its_direction(rig):
    rig.run(1.5, force=(30.0, 40.0, 0.0))
    assert rig.emulator.force == pytest.approx((1.8, 2.4, 0.0), abs=0.05)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_force_that_is_not_a_number_becomes_none(rig, bad):
    rig.run(0.1, force=(2.0, 0.0, 0.0))
    with pytest.raises(DeviceError, match="not a number"):
        rig.device.write_force((bad, 0.0, 0.0))
    for _ in range(5):
        rig.clock.now += TICK
        rig.emulator.turn()
        rig.device.read()
    assert rig.emulator.force == ZERO3


def test_a_device_that_falls_silent_is_an_error_within_50_ms_and_comes_back(rig):
    rig.run(0.1)
    rig.emulator.silent = True
    rig.run(0.045)
    with pytest.raises(DeviceError, match="does not answer"):
        rig.run(0.01)
    rig.emulator.silent = False
    failures = 0
    for _ in range(20):
        try:
            rig.tick((1.0, 0.0, 0.0))
        except DeviceError:
            failures += 1
            rig.device.write_force(ZERO3)
    assert failures < 8
    assert rig.emulator.force == pytest.approx((1.0, 0.0, 0.0), abs=0.05)


def test_a_device_that_nobody_writes_to_still_answers_and_presses_nothing(rig):
    rig.run(0.1, force=(2.0, 0.0, 0.0))
    for _ in range(100):
        rig.clock.now += TICK
        rig.emulator.turn()
        rig.device.read()
    assert rig.emulator.force == ZERO3


def test_unplugging_is_an_error_when_the_next_answer_is_missing(rig):
    rig.run(0.1)
    rig.emulator.unplug()
    with pytest.raises(DeviceError, match="gone"):
        rig.run(driver.REPLY_S + 2 * TICK)
    with pytest.raises(DeviceError, match="no such serial port"):
        rig.start()
    rig.emulator.plug()
    rig.start()
    assert rig.run(0.01)[-1].homed


def test_closing_ends_the_force_and_may_be_done_twice(rig):
    rig.run(0.1, force=(2.0, 0.0, 0.0))
    rig.device.close()
    rig.emulator.turn()
    assert rig.emulator.force == ZERO3
    rig.device.close()
    with pytest.raises(DeviceError, match="not open"):
        rig.device.read()


def test_no_device_is_told_with_its_identity():
    with pytest.raises(DeviceError, match="2341:003e"):
        TwoDiy("", Clock()).open()


@pytest.mark.parametrize(
    "kinds", [("drop",), ("duplicate",), ("truncate",), ("drop", "duplicate", "truncate")]
)
def test_one_byte_in_a_hundred_spoilt_gives_no_false_place_and_sync_within_two_packets(kinds):
    rig = Rig(motion=circle(0.03, 2.0))
    rig.start()
    faults = rig.emulator.faults = Faults(**{kind: 0.01 / len(kinds) for kind in kinds})
    ticks, longest = 10_000, 0.0
    for _ in range(ticks):
        state = rig.tick()
        assert state.homed
        assert state.buttons == 0
        longest = max(longest, rig.clock.now - state.device_time)
        assert math.dist(state.position, rig.emulator._hand._state.position) <= 0.01
    assert faults.events > 0.05 * ticks
    # An answer cut short is given up after 5 ms; the next one that comes whole is believed.
    assert longest <= 3 * (driver.REPLY_S + 2 * TICK)
    rig.device.close()
    rig.emulator.close()


class Instead:
    """A line that brings something else instead."""

    def __init__(self, answer):
        self.answer = answer

    def spoil(self, data):
        return self.answer


def test_a_jump_that_no_hand_makes_is_passed_over():
    rig = Rig()
    rig.start()
    rig.run(0.05)
    rig.emulator.faults = Instead(struct.pack("<Bff", 5, 60.0, 120.0))
    state = rig.tick()
    assert math.hypot(*state.position) < 1e-3
    rig.emulator.faults = Faults()
    rig.run(0.05)
    assert rig.device.refused == 1
    rig.device.close()
    rig.emulator.close()


def test_end_to_end_in_real_time_with_the_emulator_in_its_own_process(tmp_path):
    sender = StickSender(str(tmp_path / "hand"))
    device = make_device(f"emulated:two-diy@{tmp_path}/hand")
    device.open()
    until, position = time.monotonic() + 30.0, ZERO3
    while math.dist(position, (0.03, -0.02, 0.0)) > 1e-3:
        assert time.monotonic() < until
        sender.send((0.03, -0.02, 0.0), 0.0, 0, time.monotonic())
        with contextlib.suppress(DeviceError):  # the machine may be busy for longer than a silence
            position = device.read().position
            device.write_force(ZERO3)
        time.sleep(TICK)
    device.close()
    sender.close()
