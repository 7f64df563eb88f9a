"""The two software handles, over real sockets and a virtual clock."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.device import ZERO3, DeviceError, HapticDevice
from drivers.scripted import ScriptedHand
from drivers.stick import StickSender
from drivers.virtual import VirtualHandle

TICK = 1e-3


class Clock:
    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


class Rig:
    """A handle, its sender and their common clock. The sender repeats its sample at 25 Hz as ticks pass."""

    def __init__(self, make, path):
        self.clock = Clock()
        self.device: HapticDevice = make(path, self.clock)
        self.sender = StickSender(path)
        self.ticks = 0

    def send(self, position, yaw=0.0, buttons=0):
        assert self.sender.send(position, yaw, buttons, self.clock.now)

    def run(self, seconds, position, yaw=0.0, buttons=0, force=ZERO3):
        states = []
        for _ in range(round(seconds / TICK)):
            self.clock.now += TICK
            if self.ticks % 40 == 0:
                self.send(position, yaw, buttons)
            self.ticks += 1
            states.append(self.device.read())
            self.device.write_force(force)
        return states


@pytest.fixture(params=[VirtualHandle, ScriptedHand], ids=["virtual", "scripted"])
def rig(request, tmp_path):
    rig = Rig(request.param, str(tmp_path / "stick"))
    rig.device.open()
    yield rig
    rig.device.close()
    rig.sender.close()


@pytest.fixture
def virtual(tmp_path):
    rig = Rig(VirtualHandle, str(tmp_path / "stick"))
    rig.device.open()
    yield rig
    rig.device.close()
    rig.sender.close()


@pytest.fixture
def scripted(tmp_path):
    rig = Rig(ScriptedHand, str(tmp_path / "stick"))
    rig.device.open()
    yield rig
    rig.device.close()
    rig.sender.close()


def test_reading_before_open_and_after_close_is_refused(rig, tmp_path):
    unopened = type(rig.device)(str(tmp_path / "other"), rig.clock)
    with pytest.raises(DeviceError, match="not open"):
        unopened.read()
    unopened.close()
    rig.device.close()
    with pytest.raises(DeviceError, match="not open"):
        rig.device.read()


def test_it_reaches_what_the_sender_asks(rig):
    state = rig.run(1.5, (0.03, -0.02, 0.05), yaw=0.4, buttons=3)[-1]
    assert state.position == pytest.approx((0.03, -0.02, 0.05), abs=1e-6)
    assert state.velocity == pytest.approx(ZERO3, abs=1e-5)
    assert state.yaw == pytest.approx(0.4, abs=1e-6)
    assert state.buttons == 3
    assert state.homed
    assert rig.clock.now - 0.041 <= state.device_time <= rig.clock.now


def test_a_handle_never_leaves_its_workspace(rig):
    for state in rig.run(1.5, (0.5, -0.5, 0.5)):
        assert math.hypot(*state.position) <= rig.device.info.workspace * (1 + 1e-12)
    edge = rig.device.info.workspace / math.sqrt(3)
    assert state.position == pytest.approx((edge, -edge, edge), abs=1e-6)


def test_a_handle_never_heard_or_silent_is_an_error_until_the_sender_is_back(rig):
    with pytest.raises(DeviceError, match="no stick yet"):
        rig.device.read()
    rig.run(0.2, (0.05, 0.0, 0.0))
    rig.clock.now += 0.25
    for _ in range(3):
        with pytest.raises(DeviceError, match="silent"):
            rig.device.read()
    rig.send((-0.05, 0.0, 0.0))
    state = rig.device.read()
    assert state.velocity == ZERO3
    assert rig.run(1.0, (-0.05, 0.0, 0.0))[-1].position == pytest.approx((-0.05, 0.0, 0.0), abs=1e-4)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_force_that_is_not_a_number_becomes_no_force(rig, bad):
    rig.run(0.5, ZERO3, force=(2.0, 0.0, 0.0))
    with pytest.raises(DeviceError, match="not a number"):
        rig.device.write_force((0.0, bad, 0.0))
    before = rig.device.read()
    after = None
    for _ in range(1500):
        rig.clock.now += TICK
        rig.send(ZERO3)
        after = rig.device.read()
    assert after is not None
    assert all(map(math.isfinite, (*before.position, *after.position)))
    assert after.position == pytest.approx(ZERO3, abs=1e-6)


def test_the_virtual_handle_remembers_the_force_within_its_limit(virtual):
    virtual.run(0.1, ZERO3, force=(1.0, -2.0, 0.5))
    assert virtual.device.force == (1.0, -2.0, 0.5)
    virtual.device.write_force((300.0, 0.0, 400.0))
    assert virtual.device.force == pytest.approx((6.0, 0.0, 8.0))
    virtual.clock.now += 1.0
    with pytest.raises(DeviceError):
        virtual.device.read()
    assert virtual.device.force == ZERO3


def test_the_virtual_handle_knows_its_speed(virtual):
    state = None
    for step in range(40):
        virtual.clock.now += 0.02
        virtual.send((-0.05 + 0.1 * 0.02 * step, 0.0, 0.0))
        state = virtual.device.read()
    assert state is not None
    assert state.velocity == pytest.approx((0.1, 0.0, 0.0), abs=1e-4)
    assert virtual.run(0.5, state.position)[-1].velocity == pytest.approx(ZERO3, abs=1e-4)


def test_the_speed_is_the_same_whether_datagrams_are_read_one_by_one_or_together(tmp_path):
    def fly(read_every):
        rig = Rig(VirtualHandle, str(tmp_path / "stick"))
        rig.device.open()
        state = None
        for step in range(1, 41):
            rig.clock.now += 0.02
            rig.send((0.05 * math.sin(step / 3), 0.0, 0.0))
            if step % read_every == 0:
                state = rig.device.read()
        rig.device.close()
        rig.sender.close()
        return state

    assert fly(1) == fly(5)


@settings(max_examples=25)
@given(st.lists(st.tuples(st.floats(0, 0.3), *(st.floats(-1, 1),) * 3), min_size=1, max_size=20))
def test_the_speed_is_always_bounded(tmp_path_factory, moves):
    rig = Rig(VirtualHandle, str(tmp_path_factory.mktemp("s") / "stick"))
    rig.device.open()
    try:
        for wait, x, y, z in moves:
            rig.clock.now = math.nextafter(rig.clock.now + wait, math.inf)
            rig.send((x, y, z))
            speed = math.hypot(*rig.device.read().velocity)
            # Each datagram adds at most the workspace's width over the filter's time constant.
            assert speed <= len(moves) * 0.2 / 0.05
    finally:
        rig.device.close()
        rig.sender.close()


def test_the_scripted_hand_moves_like_an_arm_and_not_like_a_stick(scripted):
    states = scripted.run(1.0, (0.05, 0.0, 0.0))
    assert states[0].position == pytest.approx(ZERO3, abs=1e-3)
    assert 0.025 < states[140].position[0] < 0.035
    steps = [b.position[0] - a.position[0] for a, b in pairwise(states)]
    assert max(steps) < 0.05 * 10.0 * TICK
    assert min(steps) >= 0.0


def test_the_scripted_hand_yields_to_force_and_comes_back(scripted):
    pushed = scripted.run(1.5, (0.03, 0.0, 0.0), force=(-2.7, 0.0, 0.0))[-1]
    assert pushed.position[0] == pytest.approx(0.01, abs=1e-5)
    assert scripted.run(1.5, (0.03, 0.0, 0.0))[-1].position[0] == pytest.approx(0.03, abs=1e-5)


def test_no_force_of_before_a_silence_acts_after_it(scripted):
    scripted.run(1.0, ZERO3, force=(5.0, 0.0, 0.0))
    resting = scripted.device.read().position
    scripted.clock.now += 1.0
    with pytest.raises(DeviceError):
        scripted.device.read()
    scripted.send(ZERO3)
    assert scripted.device.read().position == resting
    states = []
    for _ in range(100):
        scripted.clock.now += TICK
        states.append(scripted.device.read().position[0])
    assert states == sorted(states, reverse=True)
    assert states[-1] < 0.8 * resting[0]


def test_a_force_beyond_the_motor_saturates_keeping_its_direction(scripted):
    state = scripted.run(1.5, ZERO3, force=(300.0, 0.0, 400.0))[-1]
    assert state.position == pytest.approx((6.0 / 135, 0.0, 8.0 / 135), abs=1e-5)


def test_force_does_not_push_the_scripted_hand_out_of_its_workspace(scripted):
    states = scripted.run(1.5, (0.1, 0.0, 0.0), force=(10.0, 0.0, 0.0))
    assert max(math.hypot(*state.position) for state in states) <= 0.1 * (1 + 1e-12)
    assert states[-1].velocity == pytest.approx(ZERO3, abs=0.01)
    assert scripted.run(1.5, (0.05, 0.0, 0.0))[-1].position == pytest.approx((0.05, 0.0, 0.0), abs=1e-5)


def test_opening_again_starts_from_the_centre_at_rest(scripted):
    scripted.run(1.0, (0.05, 0.0, 0.0), yaw=0.5)
    scripted.device.close()
    scripted.device.open()
    scripted.clock.now += 0.01
    scripted.send((0.05, 0.0, 0.0))
    state = scripted.device.read()
    assert (state.position, state.velocity, state.yaw) == (ZERO3, ZERO3, 0.0)
