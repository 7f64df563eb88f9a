"""Joysticks: axes, dead zone, effects, and the driver against SDL's virtual joystick, in virtual time."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3, DeviceError
from drivers.emulators.hand import EmulatedHand, Intention
from drivers.emulators.joystick import JoystickEmulator, VirtualJoystick
from drivers.joystick import driver, rendering, sdl, sticks
from drivers.joystick.driver import WORKSPACE, Joystick
from drivers.smooth import Smooth
from drivers.stick import StickSender

TICK = 4e-3
raw = st.integers(-32768, 32767)


class Clock:
    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


class Rig:
    def __init__(self, motion=lambda t: Intention(), **settings) -> None:
        self.clock = Clock()
        self.emulator = JoystickEmulator(EmulatedHand(WORKSPACE, self.clock, motion=motion), self.clock)
        self.device = Joystick("Virtual gamepad", self.clock, **settings)

    def run(self, seconds, force=ZERO3):
        states = []
        for _ in range(round(seconds / TICK)):
            self.clock.now += TICK
            self.emulator.turn()
            states.append(self.device.read())
            self.device.write_force(force)
        return states

    def close(self):
        self.device.close()
        self.emulator.close()


@pytest.fixture
def rig():
    rig = Rig(deadzone=0.0)
    rig.device.open()
    yield rig
    rig.close()


# Axes


@pytest.mark.parametrize(
    ("mode", "axes", "expected"),
    [
        (1, (100, 200, 300, 400), (200, 300, 400, 100)),
        (2, (100, 200, 300, 400), (400, 300, 200, 100)),
        (3, (100, 200, 300, 400), (200, 100, 400, 300)),
        (4, (100, 200, 300, 400), (400, 100, 200, 300)),
    ],
)
def test_the_modes_are_those_of_radio_control(mode, axes, expected):
    found = sticks.deflection(axes, sticks.gamepad(mode), 0.0)
    assert [round(-part * 32767) for part in found] == list(expected)


def test_pushing_the_right_stick_away_flies_forward_in_mode_2():
    assert sticks.deflection((0, 0, 0, -32768), sticks.gamepad(2), 0.08) == (1.0, 0.0, 0.0, 0.0)
    assert sticks.deflection((32767, 0, 0, 0), sticks.gamepad(2), 0.08) == (0.0, 0.0, 0.0, -1.0)


@given(st.lists(raw, max_size=8), st.sampled_from([1, 2, 3, 4]), st.floats(0, sticks.WIDEST_DEADZONE))
def test_a_deflection_is_always_within_one_and_odd(axes, mode, zone):
    found = sticks.deflection(axes, sticks.gamepad(mode), zone)
    assert all(-1.0 <= part <= 1.0 for part in found)
    mirrored = sticks.deflection([-max(axis, -32767) for axis in axes], sticks.gamepad(mode), zone)
    assert mirrored == pytest.approx([-part for part in found], abs=1e-12)


@given(raw, raw, st.floats(0, sticks.WIDEST_DEADZONE))
def test_farther_out_is_never_less_and_there_is_no_step_at_the_dead_zone(one, other, zone):
    source = (sticks.Source(0, 1.0), None, None, None)
    low, high = (sticks.deflection([axis], source, zone).forward for axis in sorted((one, other)))
    assert low <= high
    if abs(one) <= zone * 32767:
        assert sticks.deflection([one], source, zone).forward == 0.0
    assert high - low <= (abs(one - other) + 1) / 32767 / (1.0 - zone) + 1e-12


def test_a_flight_sticks_axes_can_be_told():
    sources = sticks.chosen({"forward": "-1", "left": "+0", "up": "2"})
    assert sticks.deflection((32767, -32767, 16383, 5), sources, 0.0) == pytest.approx(
        (1, 1, 0.5, 0), abs=1e-4
    )
    assert sticks.flight_stick(2) == (sticks.Source(1, -1.0), sticks.Source(0, -1.0), None, None)


@pytest.mark.parametrize(
    ("key", "bad"),
    [
        ("mode", 0), ("mode", 5), ("mode", "2"), ("mode", None), ("mode", [2]),
        ("deadzone", -0.1), ("deadzone", 0.6), ("deadzone", math.nan), ("deadzone", "0"),
        ("axes", 3), ("axes", {"forwards": "1"}), ("axes", {"forward": "x"}), ("axes", {"left": "-100"}),
    ],
)  # fmt: skip
def test_a_setting_that_is_none_is_told_with_its_key(key, bad):
    with pytest.raises(DeviceError, match=f"devices.joystick.{key}"):
        Joystick("", **{key: bad})


# The driver on SDL's virtual joystick


def test_it_reads_what_the_hand_does(rig):
    rig.emulator._hand._motion = lambda t: Intention((0.04, -0.03, 0.02), 0.5, 0b101)
    state = rig.run(1.5)[-1]
    assert state.position == pytest.approx((0.04, -0.03, 0.02), abs=1e-5)
    assert state.velocity == pytest.approx(ZERO3, abs=1e-3)
    assert state.yaw == pytest.approx(0.5, abs=1e-4)
    assert state.buttons == 0b101
    assert state.homed
    assert state.device_time == rig.clock.now
    assert (rig.device.info.name, rig.device.info.axes) == ("Virtual gamepad", 4)
    assert rig.device.info.renders == "rumble"


def test_the_handle_never_leaves_its_workspace(rig):
    rig.emulator._hand.workspace = 1.0
    rig.emulator._hand._motion = lambda t: Intention((1.0, 1.0, -1.0), 2.0)
    state = rig.run(2.0)[-1]
    assert math.hypot(*state.position) == pytest.approx(WORKSPACE)
    assert state.yaw == pytest.approx(driver.FULL_YAW)


def test_the_mode_of_the_users_settings_counts():
    rig = Rig(motion=lambda t: Intention((0.04, 0.0, 0.0)), mode=1, deadzone=0.0)
    rig.device.open()
    assert rig.run(1.5)[-1].position == pytest.approx((0.0, 0.0, 0.04), abs=1e-5)
    rig.close()


def test_force_becomes_rumble_and_ends_with_it(rig):
    rig.run(0.1, force=(3.0, 0.0, 4.0))
    assert rig.emulator.rumble == (32768, 32768)
    rig.run(0.1, force=(30.0, 0.0, 40.0))
    assert rig.emulator.rumble == (65535, 65535)
    rig.run(TICK, force=ZERO3)
    assert rig.emulator.rumble == (0, 0)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_force_that_is_not_a_number_becomes_none(rig, bad):
    rig.run(0.1, force=(3.0, 0.0, 4.0))
    with pytest.raises(DeviceError, match="not a number"):
        rig.device.write_force((0.0, bad, 0.0))
    assert rig.emulator.rumble == (0, 0)


def test_closing_ends_the_rumble_and_may_be_done_twice(rig):
    rig.run(0.1, force=(3.0, 0.0, 4.0))
    rig.device.close()
    assert rig.emulator.rumble == (0, 0)
    rig.device.close()
    with pytest.raises(DeviceError, match="not open"):
        rig.device.read()
    with pytest.raises(DeviceError, match="not open"):
        rig.device.write_force(ZERO3)


def test_unplugging_is_an_error_at_once_and_plugging_in_again_offers_it_again(rig):
    rig.run(0.05)
    rig.emulator.unplug()
    with pytest.raises(DeviceError, match="gone"):
        rig.device.read()
    with pytest.raises(DeviceError, match="No joystick"):
        rig.device.open()
    rig.emulator.plug()
    rig.device.open()
    assert rig.run(0.05)[-1].homed


def test_triggers_are_buttons(rig):
    from drivers.joystick.sdl import sdl as library

    for axis, bit in ((4, 21), (5, 22)):
        library().SDL_JoystickSetVirtualAxis(rig.emulator._handle, axis, 32767)
        assert rig.run(TICK)[-1].buttons == 1 << bit
        library().SDL_JoystickSetVirtualAxis(rig.emulator._handle, axis, -32768)


def test_it_is_opened_by_identity_and_not_by_number(rig):
    (identity,) = sdl.connected()
    assert identity.name == "Virtual gamepad"
    assert len(identity.guid) == 32
    for address in (identity.guid, identity.guid.upper(), "virtual", ""):
        device = Joystick(address, rig.clock)
        device.open()
        device.close()
    with pytest.raises(
        DeviceError, match="Wingman: no joystick is known by this; connected: Virtual gamepad"
    ):
        Joystick("Wingman").open()


def test_it_is_discovered(rig):
    (found,) = driver.discover()
    assert (found.name, found.renders, found.usable) == ("Virtual gamepad", "rumble", True)
    assert found.uri == f"joystick:{rig.device.info.serial}"


def test_one_that_may_not_be_read_is_listed_with_the_reason(tmp_path):
    inputs = tmp_path / "devices"
    inputs.write_text(
        'I: Bus=0003\nN: Name="Keyboard"\nH: Handlers=sysrq kbd event0\n\n'
        'I: Bus=0003\nN: Name="Some Pad"\nH: Handlers=event17 js0\n\n'
    )
    assert driver._forbidden(inputs, lambda path, mode: True) == []
    (found,) = driver._forbidden(inputs, lambda path, mode: path != "/dev/input/event17")
    assert not found.usable
    assert (found.name, "/dev/input/event17" in found.why) == ("Some Pad", True)
    assert "usermod -aG input" in found.remedy
    assert driver._forbidden(tmp_path / "none", os.access) == []


def test_a_hand_in_another_program_moves_the_virtual_joystick(tmp_path):
    clock = Clock()
    device = VirtualJoystick(str(tmp_path / "hand"), clock)
    sender = StickSender(str(tmp_path / "hand"))
    device.open()
    for _ in range(400):
        clock.now += TICK
        sender.send((0.05, 0.0, 0.0), 0.0, 2, clock.now)
        state = device.read()
        device.write_force((5.0, 0.0, 0.0))
    assert state.position[0] == pytest.approx(0.1 * (0.5 - 0.08) / 0.92, abs=1e-4)
    assert state.buttons == 2
    device.close()
    device.close()
    sender.close()
    assert sdl.connected() == []


# Constant force. No joystick here has motors, so what SDL is told is looked at.


@given(st.tuples(*(st.floats(-20, 20),) * 3))
def test_a_push_comes_from_the_other_side(force):
    told = rendering.push(force)
    forward, left, _ = force
    strength = math.hypot(forward, left)
    assert told.level == pytest.approx(32767 * min(1.0, strength / rendering.FULL_FORCE), abs=1)
    if strength > 1e-6:
        # SDL: x right, y toward the operator; a force that comes from there pushes the other way.
        pushed = (-told.from_x * strength / 10_000, -told.from_y * strength / 10_000)
        assert pushed == pytest.approx((-left, -forward), abs=1e-4 * strength)


def test_the_effect_is_a_constant_force_that_ends_by_itself():
    made = rendering.effect(rendering.push((-10.0, 0.0, 0.0)))
    library = sdl.sdl()
    assert made.type == made.constant.type == library.SDL_HAPTIC_CONSTANT
    assert made.constant.direction.type == library.SDL_HAPTIC_CARTESIAN
    assert list(made.constant.direction.dir) == [0, -10_000, 0]
    assert (made.constant.level, made.constant.length) == (32767, rendering.LASTS_MS)
    assert (made.constant.delay, made.constant.fade_length, made.constant.attack_length) == (0, 0, 0)


class Told:
    renders = "force"

    def __init__(self):
        self.forces = []

    def render(self, force):
        self.forces.append(force)

    def close(self):
        pass


def test_a_steady_force_is_told_again_before_it_ends_and_a_small_change_waits():
    clock, told = Clock(), Told()
    sparing = rendering.Sparing(told, clock)
    for _ in range(250):
        clock.now += TICK
        sparing.render((1.0, 0.0, 0.0))
    assert rendering.AGAIN_S < rendering.LASTS_MS / 1e3 / 2
    assert len(told.forces) == pytest.approx(1.0 / rendering.AGAIN_S, abs=2)
    before = len(told.forces)
    clock.now += TICK
    sparing.render((1.05, 0.0, 0.0))
    assert len(told.forces) <= before + 1
    clock.now += rendering.SHORTEST_S
    sparing.render((2.0, 0.0, 0.0))
    assert told.forces[-1] == (2.0, 0.0, 0.0)
    sparing.render(ZERO3)
    sparing.render(ZERO3)
    assert told.forces[-2:] == [(2.0, 0.0, 0.0), ZERO3]


# Velocity


@given(st.floats(-1, 1), st.floats(0.002, 0.02))
def test_a_steady_motion_is_known_after_a_few_time_constants(speed, tick):
    smooth = Smooth()
    for step in range(round(0.5 / tick)):
        smooth.add(10.0 + step * tick, (speed * step * tick, 0.0, -speed * step * tick))
    assert smooth.velocity == pytest.approx((speed, 0.0, -speed), abs=1e-3 * abs(speed) + 1e-9)


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(-0.1, 0.1)), max_size=50))
def test_velocity_is_finite_whatever_comes(moves):
    smooth, t = Smooth(), 0.0
    for wait, place in moves:
        t += wait
        smooth.add(t, (place, place, place))
        assert all(map(math.isfinite, smooth.velocity))


# The process


def test_sdl_leaves_the_programs_signals_alone_and_needs_no_display():
    program = """
import os, signal, sys
from drivers.joystick import sdl
sdl.update()
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
try:
    os.kill(os.getpid(), signal.SIGINT)
    sdl.update()
except KeyboardInterrupt:
    sys.exit(7)
"""
    environment = {
        key: value for key, value in os.environ.items() if key not in {"DISPLAY", "SDL_VIDEODRIVER"}
    }
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], env=environment, check=False)
    assert done.returncode == 7
    assert signal.SIGINT


def test_without_its_library_it_says_what_to_install():
    program = """
import sys
sys.modules["sdl2"] = None
from drivers.joystick.driver import Joystick, discover
from drivers.device import DeviceError
(found,) = discover()
assert not found.usable and "groundstation[joystick]" in found.remedy, found
try:
    Joystick("").open()
except DeviceError as error:
    assert "groundstation[joystick]" in str(error)
else:
    raise AssertionError
"""
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
