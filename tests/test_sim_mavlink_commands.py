"""MAV_CMD_* to the simulated vehicle: accepted, denied with a reason, or cleanly unsupported."""

import math

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import DT, LOCAL_NED, NAN, VELOCITY_YAW_RATE, Wire

from sim import frames
from sim.autopilot.modes import Mode
from sim.mavlink.dialect import AVAILABLE_MODES
from sim.scenario import Box


def test_what_is_not_known_is_cleanly_unsupported():
    assert Wire().command(m.MAV_CMD_DO_ORBIT) == m.MAV_RESULT_UNSUPPORTED
    for command in (m.MAV_CMD_DO_FENCE_ENABLE, m.MAV_CMD_IMAGE_START_CAPTURE, m.MAV_CMD_DO_SET_STANDARD_MODE):
        assert Wire().command(command, 99) == m.MAV_RESULT_UNSUPPORTED


def test_a_restart_is_asked_for_on_the_ground_only():
    wire = Wire()
    assert wire.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 0) == m.MAV_RESULT_ACCEPTED
    assert wire.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 2) == m.MAV_RESULT_UNSUPPORTED
    wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0)
    assert wire.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == m.MAV_RESULT_TEMPORARILY_REJECTED
    wire.run(DT)
    assert "Reboot denied: armed" in wire.texts()
    wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 0)
    assert not wire.endpoint.reboot_asked
    assert wire.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == m.MAV_RESULT_ACCEPTED
    assert wire.endpoint.reboot_asked


def test_commands_to_others_are_not_answered():
    wire = Wire()
    for target in ((2, 1), (1, 100)):
        message = m.MAVLink_command_long_message(
            *target, m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0
        )
        wire.send(message)
    assert not any(message.get_type() == "COMMAND_ACK" for message in wire.run(0.1))
    assert not wire.sim.autopilot.armed


def test_commands_to_everybody_are():
    assert Wire().command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0, target=(0, 0)) == m.MAV_RESULT_ACCEPTED


def test_disarming_in_the_air_is_rejected_and_said():
    wire = Wire().take_off()
    assert wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 0) == m.MAV_RESULT_TEMPORARILY_REJECTED
    wire.run(DT)
    assert "Disarming denied: not landed" in wire.texts()
    assert wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 21196) == m.MAV_RESULT_ACCEPTED
    assert not wire.sim.autopilot.armed


@pytest.mark.parametrize(
    ("main", "sub", "text"),
    [
        (6, 0, "Offboard denied: no setpoints are coming; stream them at 2 Hz or more before the switch"),
        (1, 0, "Manual denied: it is not simulated"),
        (4, 4, "Mission denied: no mission is on board"),
        (9, 9, "Mode 9/9 denied: it is not simulated"),
    ],
)
def test_a_mode_denied_says_why(main, sub, text):
    wire = Wire()
    assert wire.command(m.MAV_CMD_DO_SET_MODE, 1, main, sub) == m.MAV_RESULT_TEMPORARILY_REJECTED
    wire.run(DT)
    assert text in wire.texts()


@pytest.mark.parametrize(
    ("command", "mode"),
    [
        (m.MAV_CMD_NAV_LAND, Mode.LAND),
        (m.MAV_CMD_NAV_RETURN_TO_LAUNCH, Mode.RETURN),
    ],
)
def test_modes_by_command(command, mode):
    wire = Wire().take_off()
    assert wire.command(command) == m.MAV_RESULT_ACCEPTED
    assert wire.sim.autopilot.mode is mode


@pytest.mark.parametrize(("main", "sub", "mode"), [(4, 3, Mode.HOLD), (4, 5, Mode.RETURN), (4, 6, Mode.LAND)])
def test_modes_by_number_and_by_the_old_message(main, sub, mode):
    wire = Wire().take_off()
    assert wire.command(m.MAV_CMD_DO_SET_MODE, 1, main, sub) == m.MAV_RESULT_ACCEPTED
    assert wire.sim.autopilot.mode is mode
    wire.send(m.MAVLink_set_mode_message(1, 1, 4 << 16 | 3 << 24))
    wire.run(1.1)
    assert wire.newest("HEARTBEAT").custom_mode == 4 << 16 | 3 << 24


def test_take_off_by_mode():
    wire = Wire()
    wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0)
    assert wire.command(m.MAV_CMD_DO_SET_MODE, 1, 4, 2) == m.MAV_RESULT_ACCEPTED
    wire.run(1.1)
    assert wire.newest("HEARTBEAT").custom_mode == 4 << 16 | 2 << 24
    assert wire.newest("EXTENDED_SYS_STATE").landed_state == m.MAV_LANDED_STATE_TAKEOFF


def test_bad_numbers_in_commands_are_denied():
    wire = Wire()
    for params in ((NAN,), (2,), (math.inf,), (0.5,)):
        assert wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, *params) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_DO_SET_MODE, NAN, NAN, NAN) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_DO_FLIGHTTERMINATION, 0) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_SET_MESSAGE_INTERVAL, 32, NAN) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_SET_MESSAGE_INTERVAL, 0, 1000) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_DO_CHANGE_SPEED, 1, NAN) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 1e30) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_MISSION_START, NAN) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, 91, 0, 0) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_DO_REPOSITION, 0, 0, 0, 0, 0, 200, 0) == m.MAV_RESULT_DENIED


def test_a_place_is_flown_to():
    wire = Wire().take_off()
    latitude, longitude, _ = frames.geodetic(6.0, -4.0, 0.0)
    place = (round(latitude * 1e7), round(longitude * 1e7), 4.0)
    message = m.MAVLink_command_int_message(
        1, 1, m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, m.MAV_CMD_DO_REPOSITION, 0, 0, -1, 1, 0, 0.0, *place
    )
    assert wire.ask(message, "COMMAND_ACK").result == m.MAV_RESULT_ACCEPTED
    wire.run(15)
    assert wire.sim.p == pytest.approx((6.0, -4.0, 4.0, math.pi / 2), abs=0.05)


def test_take_off_to_a_height_above_the_sea():
    wire = Wire()
    wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0)
    assert wire.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, NAN, NAN, 488.0 + 5.0) == m.MAV_RESULT_ACCEPTED
    wire.run(12)
    assert wire.sim.p[2] == pytest.approx(5.0, abs=0.2)


def test_a_take_off_too_low_is_raised_and_said():
    """What MAVProxy's `takeoff 5` sends: 5 m above sea level."""
    wire = Wire()
    wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0)
    assert wire.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 5.0) == m.MAV_RESULT_ACCEPTED
    wire.run(8)
    assert "Using minimum takeoff altitude: 2.50 m" in wire.texts()
    assert wire.sim.p[2] == pytest.approx(2.5, abs=0.2)


def test_standard_modes_name_the_custom_ones():
    wire = Wire()
    assert wire.command(m.MAV_CMD_REQUEST_MESSAGE, AVAILABLE_MODES, 0) == m.MAV_RESULT_ACCEPTED
    assert wire.command(m.MAV_CMD_REQUEST_MESSAGE, AVAILABLE_MODES, 99) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_DO_SET_STANDARD_MODE, m.MAV_STANDARD_MODE_SAFE_RECOVERY) == (
        m.MAV_RESULT_ACCEPTED
    )
    assert wire.sim.autopilot.wanted is Mode.RETURN


@pytest.mark.parametrize(
    ("base", "mode"),
    [(m.MAV_MODE_FLAG_AUTO_ENABLED, "Mission"), (m.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED, "Manual")],
)
def test_a_plain_base_mode_is_taken_for_a_custom_one(base, mode):
    wire = Wire()
    assert wire.command(m.MAV_CMD_DO_SET_MODE, base, 0, 0) == m.MAV_RESULT_TEMPORARILY_REJECTED
    wire.run(DT)
    assert wire.texts()[-1].startswith(f"{mode} denied: ")


def test_home_is_set_and_asked_for():
    wire = Wire().take_off()
    latitude, longitude, _ = frames.geodetic(7.0, 8.0, 0.0)
    assert (
        wire.command(m.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, latitude, longitude, 488.0) == m.MAV_RESULT_ACCEPTED
    )
    assert wire.command(m.MAV_CMD_GET_HOME_POSITION) == m.MAV_RESULT_ACCEPTED
    home = wire.newest("HOME_POSITION")
    # A COMMAND_LONG's latitude is a float: half a metre is left of it.
    assert (home.x, home.y, home.z) == pytest.approx((8.0, 7.0, 0.0), abs=0.6)
    wire.fly(2.0, LOCAL_NED, VELOCITY_YAW_RATE, v=(1.0, 0.0, 0.0))
    assert wire.command(m.MAV_CMD_DO_SET_HOME, 1) == m.MAV_RESULT_ACCEPTED
    assert wire.sim.autopilot.home[:2] == pytest.approx(wire.sim.p[:2], abs=0.05)


def test_failures_are_injected():
    wire = Wire()
    wire.run(1)
    assert wire.newest("GPS_RAW_INT").fix_type == m.GPS_FIX_TYPE_3D_FIX
    gps, off = m.FAILURE_UNIT_SENSOR_GPS, m.FAILURE_TYPE_OFF
    assert wire.command(m.MAV_CMD_INJECT_FAILURE, gps, off) == m.MAV_RESULT_ACCEPTED
    wire.run(8)
    assert wire.newest("GPS_RAW_INT").fix_type == m.GPS_FIX_TYPE_NO_FIX
    health = wire.newest("SYS_STATUS").onboard_control_sensors_health
    assert not health & m.MAV_SYS_STATUS_SENSOR_GPS
    assert not wire.newest("ESTIMATOR_STATUS").flags & m.ESTIMATOR_POS_HORIZ_ABS
    assert wire.command(m.MAV_CMD_INJECT_FAILURE, gps, m.FAILURE_TYPE_OK) == m.MAV_RESULT_ACCEPTED
    wire.run(1.1)
    assert wire.newest("GPS_RAW_INT").fix_type == m.GPS_FIX_TYPE_3D_FIX
    motor = m.FAILURE_UNIT_SYSTEM_MOTOR
    assert wire.command(m.MAV_CMD_INJECT_FAILURE, motor, off) == m.MAV_RESULT_UNSUPPORTED


def test_what_forbids_arming_is_said_when_asked():
    wire = Wire()
    wire.sim.battery.remaining = 0.02
    assert wire.command(m.MAV_CMD_RUN_PREARM_CHECKS) == m.MAV_RESULT_ACCEPTED
    wire.run(DT)
    assert any(text.startswith("Preflight Fail: ") for text in wire.texts())


def test_a_collision_is_told_as_critical():
    wire = Wire(
        obstacle=(Box("a wall with a name that is long enough to be cut", (3.0, 0.0, 2.0), (0.2, 9.0, 9.0)),)
    )
    wire.take_off().fly(4.0, LOCAL_NED, VELOCITY_YAW_RATE, v=(0.0, 2.0, 0.0))
    texts = [message for message in wire.heard if message.get_type() == "STATUSTEXT"]
    told = [message for message in texts if message.severity == m.MAV_SEVERITY_CRITICAL]
    assert (
        "".join(message.text for message in told)
        == "Collision with a wall with a name that is long enough to be cut"
    )
    assert [message.chunk_seq for message in told] == [0, 1]
    assert len({message.id for message in told}) == 1
