"""Arming, modes and failsafes in virtual time, on the whole simulator; no socket, no clock."""

import math

import pytest
from sim_flight import DT, Flight

from sim.autopilot.guidance import FREE, Target
from sim.autopilot.modes import Mode
from sim.autopilot.notices import Severity
from sim.scenario import Box, Gust, ScenarioError, Sphere, Wind


@pytest.mark.parametrize("model", ["kinematic", "dynamic"])
def test_a_flight_from_pad_to_pad(model):
    flight = Flight(model).take_off(2.0)
    assert flight.sim.p == pytest.approx((0.0, 0.0, 2.0, 0.0), abs=0.05)
    flight.fly((1.0, 0.0, 0.0), 3.0)
    assert flight.sim.p[0] > 2.0
    assert flight.autopilot.set_mode(Mode.LAND).ok
    flight.until(lambda: not flight.autopilot.armed, 15)
    assert flight.sim.p[2] == 0.0
    assert flight.autopilot.mode is Mode.HOLD
    assert flight.texts[-2:] == ["Landing detected", "Disarmed by landing"]
    assert not flight.sim.collisions


def test_without_orders_nothing_moves():
    flight = Flight(wind=Wind(mean=(5.0, 0.0, 3.0)))
    flight.run(2)
    assert flight.sim.p == (0.0, 0.0, 0.0, 0.0)
    flight.autopilot.arm()
    flight.run(2)
    assert flight.sim.p == (0.0, 0.0, 0.0, 0.0)


def test_take_off_ends_at_the_parameter_and_may_be_ordered_before_arming():
    flight = Flight().set("MIS_TAKEOFF_ALT", 4.0)
    assert flight.autopilot.take_off().ok
    flight.run(1)
    assert flight.sim.p[2] == 0.0
    assert flight.autopilot.arm().ok
    flight.run(12)
    assert flight.sim.p[2] == pytest.approx(4.0, abs=0.1)


def test_armed_without_take_off_it_disarms_after_ten_seconds():
    flight = Flight()
    flight.autopilot.arm()
    flight.run(9.9)
    assert flight.autopilot.armed
    flight.run(0.2)
    assert not flight.autopilot.armed
    assert flight.texts[-1] == "Disarmed by auto preflight disarming"


def test_after_landing_it_disarms_when_the_parameter_says():
    flight = Flight().set("COM_DISARM_LAND", 5.0).take_off()
    flight.autopilot.set_mode(Mode.LAND)
    flight.until(lambda: flight.autopilot.landed, 10)
    flight.run(4.9)
    assert flight.autopilot.armed
    flight.run(0.2)
    assert not flight.autopilot.armed


def test_pressing_it_to_the_ground_in_offboard_is_a_landing():
    flight = Flight().take_off()
    flight.fly((0.0, 0.0, -0.6), 9.0)
    assert flight.autopilot.landed
    assert not flight.autopilot.armed
    assert not flight.sim.collisions


# Refusals


def refused(flight, verdict, text):
    flight.run(DT)
    assert not verdict.ok
    assert verdict.why in flight.texts[-1]
    assert text in flight.texts[-1]


def test_disarming_in_the_air_is_refused_but_a_kill_falls():
    flight = Flight().take_off()
    refused(flight, flight.autopilot.disarm(), "Disarming denied: not landed")
    assert flight.autopilot.kill().ok
    flight.until(lambda: flight.sim.grounded, 2)
    assert [collision.name for collision in flight.sim.collisions] == ["floor"]
    refused(flight, flight.autopilot.arm(), "Arming denied: not on the ground")
    flight.run(1.5)
    assert flight.autopilot.arm().ok


def test_terminated_it_stays_on_the_ground():
    flight = Flight().take_off()
    flight.autopilot.terminate()
    flight.run(5)
    refused(flight, flight.autopilot.arm(), "Arming denied: flight was terminated")
    refused(flight, flight.autopilot.arm(force=True), "Arming denied: flight was terminated")


def test_offboard_needs_a_stream():
    flight = Flight().take_off()
    refused(flight, flight.autopilot.set_mode(Mode.OFFBOARD), "Offboard denied: no setpoints")
    flight.autopilot.offboard(Target(FREE))
    flight.run(0.6)
    refused(flight, flight.autopilot.set_mode(Mode.OFFBOARD), "Offboard denied: no setpoints")
    flight.autopilot.offboard(Target(FREE))
    flight.run(0.4)
    assert flight.autopilot.set_mode(Mode.OFFBOARD).ok


def test_arming_is_refused_in_modes_that_cannot_take_off():
    flight = Flight()
    flight.autopilot.set_mode(Mode.LAND)
    refused(flight, flight.autopilot.arm(), "Arming denied: Land cannot take off")
    flight.autopilot.offboard(Target(FREE))
    flight.autopilot.set_mode(Mode.OFFBOARD)
    flight.run(0.6)
    refused(flight, flight.autopilot.arm(), "Arming denied: Offboard without setpoints")
    flight.autopilot.set_mode(Mode.HOLD)
    assert flight.autopilot.arm().ok


def test_all_that_forbids_arming_is_listed():
    flight = Flight().set("COM_ARM_BAT_MIN", 0.5, "COM_ARM_MIS_REQ", 1)
    assert flight.autopilot.arming_obstacles() == [
        "a mission is required (COM_ARM_MIS_REQ): no mission is on board"
    ]
    flight.sim.battery.remaining = 0.4
    flight.autopilot.set_mode(Mode.RETURN)
    assert flight.autopilot.arming_obstacles() == [
        "battery at 40%; charge it",
        "Return cannot take off; switch to Hold",
        "a mission is required (COM_ARM_MIS_REQ): no mission is on board",
    ]
    assert flight.autopilot.arming_obstacle() == "battery at 40%; charge it"


def test_what_only_failsafes_fly_cannot_be_chosen():
    flight = Flight().take_off()
    refused(flight, flight.autopilot.set_mode(Mode.DESCEND), "Descend denied: only failsafes choose it")


def test_disarming_by_itself_can_be_switched_off():
    flight = Flight().set("COM_DISARM_PRFLT", -1.0, "COM_DISARM_LAND", -1.0)
    flight.autopilot.arm()
    flight.run(15)
    flight.autopilot.take_off()
    flight.run(8)
    flight.autopilot.set_mode(Mode.LAND)
    flight.until(lambda: flight.autopilot.landed, 20)
    flight.run(10)
    assert flight.autopilot.armed


def test_every_mailbox_gets_every_notice_from_its_beginning():
    flight = Flight()
    first = flight.autopilot.mailbox()
    flight.autopilot.say(Severity.INFO, "one")
    second = flight.autopilot.mailbox()
    flight.autopilot.say(Severity.INFO, "two")
    assert [notice.text for notice in first] == ["one", "two"]
    assert [notice.text for notice in second] == ["two"]
    for number in range(1000):
        flight.autopilot.say(Severity.INFO, str(number))
    assert len(first) == len(second) < 100
    assert first[-1].text == "999"


def test_an_empty_battery_is_not_armed_on_unless_forced():
    flight = Flight()
    flight.sim.battery.remaining = 0.05
    refused(flight, flight.autopilot.arm(), "Arming denied: battery at 5%")
    assert flight.autopilot.arm(force=True).ok


def test_repositioning_needs_a_flight():
    flight = Flight()
    refused(flight, flight.autopilot.reposition((1.0, 0.0, 2.0), None), "Reposition denied: not flying")
    flight.take_off()
    assert flight.autopilot.reposition((3.0, -2.0, 3.0), 1.0).ok
    flight.run(15)
    assert flight.sim.p == pytest.approx((3.0, -2.0, 3.0, 1.0), abs=0.05)


def test_home_is_where_it_is_armed_unless_it_was_set():
    flight = Flight().take_off()
    flight.autopilot.reposition((4.0, 0.0, 2.0), None)
    flight.run(8)
    flight.autopilot.set_mode(Mode.LAND)
    flight.until(lambda: not flight.autopilot.armed, 20)
    assert flight.autopilot.home[:3] == (0.0, 0.0, 0.0)
    flight.autopilot.arm()
    assert flight.autopilot.home[0] == pytest.approx(4.0, abs=0.1)
    flight.autopilot.disarm()
    assert flight.autopilot.set_home((1.0, 2.0, 0.0, 0.5)).ok
    flight.autopilot.arm()
    assert flight.autopilot.home == (1.0, 2.0, 0.0, 0.5)


def test_the_nose_turns_toward_a_place_far_off_and_a_speed_asked_for_is_kept_until_the_end():
    flight = Flight("kinematic").take_off(3.0)
    flight.autopilot.change_speed(1.5)
    flight.autopilot.reposition((0.0, 30.0, 3.0), None)
    flight.run(6)
    assert math.hypot(*flight.sim.v[:2]) == pytest.approx(1.5, rel=1e-2)
    assert flight.sim.p[3] == pytest.approx(math.pi / 2, abs=0.05)
    flight.autopilot.change_speed(-1.0)
    flight.run(1)
    assert math.hypot(*flight.sim.v[:2]) > 3.0
    assert not flight.autopilot.change_speed(0.0).ok
    assert not flight.autopilot.change_speed(math.nan).ok


# Offboard


def test_the_offboard_velocity_is_the_reference_of_the_response_model():
    """Nothing in the autopilot corrects the Matrice 100's gain of 1/χ₁₀ forward."""
    flight = Flight().take_off().fly((1.0, 0.0, 0.0), 15.0)
    assert flight.sim.v[0] == pytest.approx(1.0 / 0.5941, rel=1e-4)
    kinematic = Flight("kinematic").take_off().fly((1.0, 0.5, 0.2), 2.0)
    assert kinematic.sim.v == pytest.approx((1.0, 0.5, 0.2, 0.0))


def test_a_world_velocity_stays_so_while_the_vehicle_turns():
    flight = Flight("kinematic").take_off()
    x, y, _, _ = flight.sim.p
    flight.fly((1.0, 0.0, 0.0), 4.0, yaw_rate=0.5)
    assert flight.sim.p[0] - x == pytest.approx(4.0, abs=0.02)
    assert flight.sim.p[1] - y == pytest.approx(0.0, abs=0.02)
    assert flight.sim.p[3] == pytest.approx(2.0, abs=0.02)


def test_offboard_speeds_are_capped_by_airframe_and_parameters():
    flight = Flight("kinematic").take_off().fly((30.0, 40.0, 0.0), 0.5, yaw_rate=20.0)
    assert math.hypot(*flight.sim.v[:2]) == pytest.approx(5.0)
    assert flight.sim.v[3] == pytest.approx(math.radians(90.0))
    flight.set("MPC_XY_VEL_MAX", 2.0).fly((30.0, 40.0, 9.0), 0.5)
    assert math.hypot(*flight.sim.v[:2]) == pytest.approx(2.0)
    assert flight.sim.v[2] == pytest.approx(3.0)


def test_an_acceleration_alone_becomes_a_velocity_from_the_present_one():
    """v = v₀ + a t on the axes that have nothing else, within the speed limits."""
    flight = Flight("kinematic").take_off().fly((1.0, 0.0, 0.0), 1.0)
    flight.follow(Target(acceleration=(0.5, None, None), velocity=(None, -0.5, None)), 2.0)
    assert flight.sim.v == pytest.approx((2.0, -0.5, 0.0, 0.0), abs=0.01)
    flight.follow(Target(acceleration=(0.0, 0.0, 0.0)), 2.0)
    assert flight.sim.v == pytest.approx((2.0, -0.5, 0.0, 0.0), abs=0.01)
    flight.follow(Target(acceleration=(9.0, None, None)), 3.0)
    assert flight.sim.v[0] == pytest.approx(5.0)
    flight.follow(Target(acceleration=(-1.0, None, None)), 1.0)
    assert flight.sim.v[0] == pytest.approx(4.0, abs=0.01)


def test_axes_may_be_steered_differently():
    """Height held by position, x flown by velocity; a velocity beside a position is fed forward."""
    flight = Flight("kinematic").take_off(2.0)
    flight.follow(Target((None, 3.0, 4.0), velocity=(1.0, None, None)), 12.0)
    assert flight.sim.v[0] == pytest.approx(1.0, abs=0.02)
    assert flight.sim.p[1:3] == pytest.approx((3.0, 4.0), abs=0.05)
    flight = Flight("dynamic").take_off(2.0)
    t, far = flight.sim.t, []

    def moving_target():
        x = flight.sim.t - t
        flight.autopilot.offboard(Target((x, 0.0, 2.0), (1.0, 0.0, 0.0), acceleration=(0.0, 0.0, 0.0)))
        far.append(abs(x - flight.sim.p[0]))

    moving_target()
    flight.autopilot.set_mode(Mode.OFFBOARD)
    flight.run(15, moving_target)
    assert far[-1] < 0.1


def test_the_yaw_rate_is_followed_while_a_position_is_held():
    flight = Flight().take_off().follow(Target((0.0, 0.0, 2.0), yaw_rate=0.3), 6.0)
    assert flight.sim.v[3] == pytest.approx(0.3, abs=0.01)
    assert flight.sim.p[:3] == pytest.approx((0.0, 0.0, 2.0), abs=0.1)


def test_an_offboard_position_is_reached_and_yaw_turns_the_short_way():
    flight = Flight().take_off()
    setpoint = Target((2.0, 1.0, 3.0), yaw=-3.0)
    flight.autopilot.offboard(setpoint)
    flight.autopilot.set_mode(Mode.OFFBOARD)
    flight.run(12, lambda: flight.autopilot.offboard(setpoint))
    assert flight.sim.p == pytest.approx((2.0, 1.0, 3.0, -3.0), abs=0.05)


def test_offboard_loss_holds_after_the_parameter():
    flight = Flight().set("COM_OBL_RC_ACT", 5).take_off().fly((1.0, 0.0, 0.0), 2.0)
    stopped = flight.sim.t
    flight.until(lambda: flight.autopilot.mode is not Mode.OFFBOARD, 3)
    assert flight.sim.t - stopped == pytest.approx(1.0, abs=0.03)
    assert flight.autopilot.mode is Mode.HOLD
    assert flight.autopilot.failsafe
    assert "Offboard setpoints lost: Hold" in flight.texts
    flight.run(8)
    assert flight.speed < 0.05
    before = flight.sim.p
    flight.run(5)
    assert math.dist(before, flight.sim.p) < 0.05


def test_setpoints_that_come_back_take_over_as_with_px4_until_the_operator_chooses_a_mode():
    flight = Flight().set("COM_OBL_RC_ACT", 5).take_off().fly((1.0, 0.0, 0.0), 2.0)
    flight.run(6)
    assert flight.mode is Mode.HOLD
    flight.run(1, lambda: flight.autopilot.offboard(Target(velocity=(1.0, 0.0, 0.0))))
    assert flight.mode is Mode.OFFBOARD
    assert not flight.autopilot.failsafe
    flight.run(3)
    assert flight.mode is Mode.HOLD
    assert flight.autopilot.set_mode(Mode.HOLD).ok
    flight.run(3, lambda: flight.autopilot.offboard(Target(velocity=(1.0, 0.0, 0.0))))
    assert flight.mode is Mode.HOLD
    assert flight.speed < 0.1


@pytest.mark.parametrize(("action", "mode"), [(3, Mode.RETURN), (4, Mode.LAND)])
def test_offboard_loss_may_return_or_land(action, mode):
    flight = Flight().set("COM_OBL_RC_ACT", action).take_off().fly((1.0, 0.0, 0.0), 2.0)
    flight.run(1.1)
    assert flight.autopilot.mode is mode


@pytest.mark.parametrize("action", [6, 7])
def test_offboard_loss_may_stop_the_motors(action):
    flight = Flight().set("COM_OBL_RC_ACT", action).take_off().fly((0.0, 0.0, 0.0), 1.0)
    flight.run(1.1)
    assert not flight.autopilot.armed
    assert flight.autopilot.terminated == (action == 6)


def test_refused_setpoints_are_no_stream_and_are_told_once_a_second():
    flight = Flight().take_off()
    flight.run(2.5, lambda: flight.autopilot.refuse_setpoint("not a number"))
    assert flight.texts.count("Setpoint refused: not a number") == 3
    assert not flight.autopilot.streaming


# Other modes and failsafes


def test_hold_stops_near_and_stays_in_gusty_wind():
    wind = Wind(mean=(1.0, -1.0, 0.0), gust=(Gust(12.0, 4.0, (2.0, 0.0, 0.5)),))
    flight = Flight(wind=wind).take_off().fly((2.0, 0.0, 0.0), 3.0)
    x = flight.sim.p[0]
    flight.autopilot.set_mode(Mode.HOLD)
    flight.run(2)
    assert 0.0 < flight.sim.p[0] - x < 3.0
    flight.run(20)
    before = flight.sim.p
    flight.run(5)
    assert math.dist(before, flight.sim.p) < 0.03


def test_wind_pushes_a_vehicle_in_offboard_off():
    flight = Flight(wind=Wind(mean=(0.0, 1.0, 0.0))).take_off()
    y = flight.sim.p[1]
    flight.fly((0.0, 0.0, 0.0), 6.0)
    assert flight.sim.p[1] - y > 0.8


def test_landing_is_soft_from_high_up():
    flight = Flight().take_off(15.0)
    flight.autopilot.set_mode(Mode.LAND)
    flight.run(1.5)
    assert flight.sim.v[2] < -1.2
    flight.until(lambda: flight.autopilot.landed, 40)
    assert not flight.sim.collisions


# Obstacles


def test_an_obstacle_stops_the_vehicle_counts_once_and_is_told():
    flight = Flight(obstacle=(Box("wall", (4.0, 0.0, 2.0), (0.2, 8.0, 4.0)),)).take_off()
    notices = []
    flight.autopilot.say = lambda severity, text: notices.append((severity, text))
    flight.fly((2.0, 0.0, 0.0), 6.0)
    assert flight.sim.p[0] == pytest.approx(4.0 - 0.1 - 0.5, abs=2e-3)
    assert flight.sim.v[0] == pytest.approx(0.0, abs=1e-9)
    assert [collision.name for collision in flight.sim.collisions] == ["wall"]
    assert (Severity.CRITICAL, "Collision with wall") in notices


def test_the_ground_hit_hard_is_a_collision():
    flight = Flight("kinematic").take_off(5.0).set("MPC_Z_VEL_MAX_DN", 4.0).fly((0.0, 0.0, -2.0), 4.0)
    assert [collision.name for collision in flight.sim.collisions] == ["floor"]


def test_a_crate_can_be_landed_on():
    flight = Flight(obstacle=(Box("crate", (4.0, 0.0, 0.5), (3.0, 3.0, 1.0)),)).take_off(3.0)
    flight.autopilot.reposition((4.0, 0.0, 3.0), None)
    flight.run(10)
    flight.autopilot.set_mode(Mode.LAND)
    flight.until(lambda: not flight.autopilot.armed, 20)
    assert flight.sim.p[2] == pytest.approx(1.5, abs=2e-3)
    assert flight.autopilot.arm().ok
    flight.autopilot.take_off(1.0)
    flight.run(8)
    assert flight.sim.p[2] == pytest.approx(2.5, abs=0.1)


def test_brushing_over_an_obstacle_is_no_landing():
    flight = Flight("kinematic", obstacle=(Sphere("balloon", (4.0, 0.0, 1.6), 0.6),)).take_off(2.3)
    flight.fly((1.0, 0.0, 0.0), 8.0)
    assert [collision.name for collision in flight.sim.collisions] == ["balloon"]
    assert flight.autopilot.armed
    assert flight.sim.p[0] > 6.0


def test_an_obstacle_on_the_pad_is_refused():
    with pytest.raises(ScenarioError, match="'ball' is within 0.5 m of the pad"):
        Flight(obstacle=(Sphere("ball", (1.0, 0.0, 0.0), 0.6),))


def test_the_same_flight_twice_is_the_same():
    ends = []
    for _ in range(2):
        wind = Wind(mean=(0.5, 0.2, 0.0))
        ends.append(Flight(wind=wind).take_off().fly((1.0, 0.3, 0.1), 2.0, 0.4).sim.p)
    assert ends[0] == ends[1]
