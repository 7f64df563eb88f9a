"""Sticks: which count, what they do in Position and Altitude mode, taking over, and their loss."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sim_flight import DT, Flight

from sim.autopilot.guidance import Target
from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters
from sim.autopilot.sticks import CENTRED, StickInput, Sticks, shaped


class ByStick(Flight):
    """A flight with a joystick in hand."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.stick = CENTRED
        self.autopilot.sticks(CENTRED)

    def run(self, seconds, each=lambda: None):
        def both():
            if self.stick is not None:
                self.autopilot.sticks(self.stick)
            each()

        super().run(seconds, both)

    def hold(self, seconds, **stick):
        """Hold the sticks somewhere."""
        self.stick = Sticks(**stick)
        self.run(seconds)
        return self

    def in_position(self):
        self.take_off(3.0)
        assert self.autopilot.set_mode(Mode.POSITION).ok
        return self


@given(st.floats(-1, 1), st.floats(0, 0.5), st.floats(0, 1))
def test_a_stick_is_shaped_evenly_and_reaches_its_ends(stick, dead, expo):
    assert shaped(stick, dead, expo) == -shaped(-stick, dead, expo)
    assert abs(shaped(stick, dead, expo)) <= 1.0
    assert shaped(1.0, dead, expo) == pytest.approx(1.0)
    assert shaped(dead, dead, expo) == 0.0
    if abs(stick) > dead:
        assert abs(shaped(stick, dead, expo)) >= abs(shaped(0.99 * stick, dead, expo))


def test_position_mode_flies_by_the_sticks_and_stops_when_they_are_let_go():
    flight = ByStick("kinematic").in_position()
    flight.hold(3.0, forward=1.0)
    assert flight.sim.v[0] == pytest.approx(5.0, rel=1e-3)
    flight.hold(4.0)
    assert flight.speed < 0.01
    x, y, z, yaw = flight.sim.p
    flight.hold(3.0)
    assert math.dist(flight.sim.p, (x, y, z, yaw)) < 0.01
    flight.hold(2.0, left=0.6, up=-0.5)
    assert flight.sim.p[1] > y + 0.5
    assert flight.sim.p[2] < z - 0.2
    flight.hold(3.0, yaw=0.5)
    assert flight.sim.p[3] > yaw + 0.3
    assert flight.mode is Mode.POSITION


def test_velocities_by_the_sticks_grow_with_the_acceleration_there_is():
    flight = ByStick("kinematic").set("MPC_ACC_HOR", 2.0).in_position()
    flight.hold(1.0, forward=1.0)
    assert flight.sim.v[0] == pytest.approx(2.0, abs=0.1)


def test_the_sticks_are_of_the_heading_and_bounded_by_parameters():
    flight = ByStick("kinematic").set("MPC_VEL_MANUAL", 3.0, "MPC_Z_VEL_MAX_UP", 1.0, "MPC_MAN_Y_MAX", 20.0)
    flight.in_position().hold(4.0, yaw=1.0)
    assert flight.sim.v[3] == pytest.approx(math.radians(20.0), rel=1e-3)
    flight.hold(3.0)
    flight.hold(3.0, forward=1.0, left=1.0, up=1.0)
    assert math.hypot(*flight.sim.v[:2]) == pytest.approx(3.0, rel=1e-3)
    assert flight.sim.v[0] == pytest.approx(flight.sim.v[1], rel=1e-2)
    assert flight.sim.v[2] == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("model", ["kinematic", "dynamic"])
def test_a_whole_flight_by_hand(model):
    flight = ByStick(model)
    assert flight.autopilot.set_mode(Mode.POSITION).ok
    assert flight.autopilot.arm().ok
    flight.hold(1.0)
    assert flight.sim.p[2] == 0.0
    flight.hold(3.0, up=0.8)
    flight.hold(2.0)
    assert flight.sim.p[2] > 1.0
    flight.stick = Sticks(up=-0.6)
    flight.until(lambda: not flight.autopilot.armed, 30)
    assert flight.mode is Mode.POSITION
    assert not flight.sim.collisions


def test_altitude_mode_holds_the_height_only():
    flight = ByStick("kinematic").take_off(3.0)
    assert flight.autopilot.set_mode(Mode.ALTITUDE).ok
    flight.hold(3.0, forward=0.7)
    assert flight.sim.v[0] > 1.0
    assert flight.sim.p[2] == pytest.approx(3.0, abs=0.05)
    flight.hold(3.0, up=0.8)
    assert flight.sim.p[2] > 3.5


# Refusals


def test_modes_by_sticks_need_sticks():
    flight = Flight().take_off()
    for mode in (Mode.POSITION, Mode.ALTITUDE):
        verdict = flight.autopilot.set_mode(mode)
        assert (verdict.ok, verdict.why) == (False, "no manual control signal")


def test_high_throttle_is_not_armed():
    flight = ByStick()
    flight.hold(0.1, up=0.5)
    flight.autopilot.set_mode(Mode.POSITION)
    assert flight.autopilot.arm().why == "throttle is high; lower it"
    flight.hold(0.1, up=-1.0)
    assert flight.autopilot.arm().ok


# Taking over


def test_sticks_take_over_from_automatic_modes():
    flight = ByStick().take_off(3.0)
    flight.hold(0.5, forward=0.2)
    assert flight.mode is Mode.HOLD
    flight.hold(0.1, forward=0.4)
    assert flight.mode is Mode.POSITION
    assert "Pilot took over using sticks" in flight.texts


@pytest.mark.parametrize(
    ("override", "mode"), [(0, Mode.HOLD), (1, Mode.POSITION), (2, Mode.HOLD), (3, Mode.POSITION)]
)
def test_the_override_of_automatic_modes_is_one_bit(override, mode):
    flight = ByStick().set("COM_RC_OVERRIDE", override).take_off(3.0).hold(0.1, yaw=0.9)
    assert flight.mode is mode


@pytest.mark.parametrize(("override", "mode"), [(1, Mode.OFFBOARD), (2, Mode.POSITION)])
def test_the_override_of_offboard_is_another(override, mode):
    flight = ByStick().set("COM_RC_OVERRIDE", override).take_off(3.0).fly((0.0, 0.0, 0.0), 1.0)
    flight.stick = Sticks(left=-0.9)
    flight.run(0.1, lambda: flight.autopilot.offboard(Target(velocity=(0.0, 0.0, 0.0))))
    assert flight.mode is mode


def test_how_far_is_the_parameter_and_counts_from_where_the_sticks_were():
    flight = ByStick().set("COM_RC_STICK_OV", 60.0).take_off(3.0).hold(0.1, forward=0.5)
    assert flight.mode is Mode.HOLD
    flight.autopilot.set_mode(Mode.LAND)
    flight.hold(0.1, forward=1.0)
    assert flight.mode is Mode.LAND
    flight.hold(0.1, forward=-0.2)
    assert flight.mode is Mode.POSITION


def test_sticks_end_a_failsafe_once_its_delay_is_over():
    flight = ByStick().set("NAV_DLL_ACT", 2).take_off(3.0)
    flight.autopilot.hear_ground_station()
    flight.until(lambda: flight.autopilot.failsafe, 12)
    flight.hold(0.5, left=0.9)
    assert flight.mode is Mode.HOLD
    flight.hold(5.0)
    assert flight.mode is Mode.RETURN
    flight.hold(0.1, left=0.9)
    assert flight.mode is Mode.POSITION
    assert "Pilot took over using sticks" in flight.texts
    flight.hold(5.0)
    assert flight.mode is Mode.POSITION
    assert not flight.autopilot.failsafe


# Loss


def test_lost_sticks_return_after_the_delay():
    flight = ByStick().in_position().hold(2.0, forward=0.5)
    flight.stick = None
    flight.run(0.45)
    assert not flight.autopilot.failsafe
    flight.run(0.1)
    assert flight.texts[-1] == "Manual control lost: Hold for 5 s, then Return"
    flight.run(5)
    assert flight.mode is Mode.RETURN
    flight.stick = CENTRED
    flight.run(1)
    assert flight.mode is Mode.RETURN
    assert flight.autopilot.set_mode(Mode.POSITION).ok
    assert flight.mode is Mode.POSITION


def test_sticks_that_were_not_there_are_not_missed_until_they_are():
    flight = Flight().take_off()
    flight.run(3)
    assert not flight.autopilot.failsafe
    flight.autopilot.sticks(CENTRED)
    flight.run(1)
    assert flight.autopilot.failsafe_reason == "Manual control lost"


def test_how_soon_sticks_are_lost_is_the_parameter():
    flight = ByStick().set("COM_RC_LOSS_T", 3.0).take_off()
    flight.stick = None
    flight.run(2.9)
    assert not flight.autopilot.failsafe
    flight.run(0.2)
    assert flight.autopilot.failsafe


# Sources


def taken(mode, history):
    """Return which sources count: history of (time, joystick)."""
    parameters = Parameters()
    parameters.set("COM_RC_IN_MODE", mode)
    sticks, counted = StickInput(parameters), []
    for number, (t, joystick) in enumerate(history, start=1):
        sticks.take(Sticks(forward=number / 100), t, joystick=joystick)
        counted.append(sticks.now.forward == number / 100)
    return counted


@pytest.mark.parametrize(
    ("mode", "counted"),
    [
        (0, [True, False, True, False]),
        (1, [False, True, False, True]),
        (2, [True, False, True, True]),
        (3, [True, False, True, False]),
        (4, [False, False, False, False]),
    ],
)
def test_the_source_is_chosen_by_the_parameter(mode, counted):
    history = [(0.0, False), (0.1, True), (0.2, False), (1.0, True)]
    assert taken(mode, history) == counted


def test_ignored_sticks_are_no_sticks():
    flight = Flight().set("COM_RC_IN_MODE", 4)
    flight.autopilot.sticks(CENTRED)
    flight.run(DT)
    assert not flight.autopilot.has_sticks
