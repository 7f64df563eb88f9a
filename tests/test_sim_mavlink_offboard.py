"""Offboard setpoints on the wire: frames, masks, refusals, loss."""

import math

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import BODY_NED, DT, LOCAL_NED, NAN, POSITION_YAW, VELOCITY_YAW_RATE, Wire

from sim import frames
from sim.autopilot.modes import Mode


@pytest.mark.parametrize("yaw_deg", [0.0, 90.0, -135.0])
def test_body_velocities_go_along_the_heading(yaw_deg):
    wire = Wire(yaw_deg=yaw_deg).take_off()
    x, y, z, _ = wire.sim.p
    wire.fly(2.0, BODY_NED, VELOCITY_YAW_RATE, v=(1.0, 0.5, -0.25))
    yaw = math.radians(yaw_deg)
    east, north = math.cos(yaw) + 0.5 * math.sin(yaw), math.sin(yaw) - 0.5 * math.cos(yaw)
    moved = (wire.sim.p[0] - x, wire.sim.p[1] - y, wire.sim.p[2] - z)
    assert moved == pytest.approx((2 * east, 2 * north, 0.5), abs=0.05)


def test_world_velocities_do_not():
    wire = Wire(yaw_deg=30.0).take_off()
    x, y, z, _ = wire.sim.p
    wire.fly(2.0, LOCAL_NED, VELOCITY_YAW_RATE, v=(1.0, 0.5, 0.25))
    moved = (wire.sim.p[0] - x, wire.sim.p[1] - y, wire.sim.p[2] - z)
    assert moved == pytest.approx((1.0, 2.0, -0.5), abs=0.05)


def test_a_positive_yaw_rate_on_the_wire_turns_clockwise():
    wire = Wire(yaw_deg=90.0).take_off()
    wire.fly(1.0, BODY_NED, VELOCITY_YAW_RATE, yaw_rate=0.5)
    assert wire.sim.p[3] == pytest.approx(math.pi / 2 - 0.5, abs=0.02)
    assert wire.newest("ATTITUDE").yaw == pytest.approx(0.5, abs=0.02)
    assert wire.newest("ATTITUDE").yawspeed == pytest.approx(0.5)


def test_positions_and_yaw_in_the_world():
    wire = Wire().take_off().fly(12.0, LOCAL_NED, POSITION_YAW, xyz=(3.0, -2.0, -4.0), yaw=math.radians(-90))
    assert wire.sim.p[:3] == pytest.approx((-2.0, 3.0, 4.0), abs=0.05)
    assert math.cos(wire.sim.p[3]) == pytest.approx(-1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"frame": BODY_NED, "mask": VELOCITY_YAW_RATE, "v": (NAN, 0, 0)}, "not a finite number"),
        ({"frame": BODY_NED, "mask": VELOCITY_YAW_RATE, "v": (0, math.inf, 0)}, "not a finite number"),
        ({"frame": BODY_NED, "mask": VELOCITY_YAW_RATE, "yaw_rate": NAN}, "not a finite number"),
        ({"frame": LOCAL_NED, "mask": POSITION_YAW, "xyz": (0, NAN, 0)}, "not a finite number"),
        ({"frame": LOCAL_NED, "mask": POSITION_YAW, "yaw": -math.inf}, "not a finite number"),
        ({"frame": 7, "mask": VELOCITY_YAW_RATE}, "frame 7 is not LOCAL_NED or BODY_NED"),
        ({"frame": LOCAL_NED, "mask": 0xFFF}, "neither position, velocity nor acceleration"),
        ({"frame": LOCAL_NED, "mask": VELOCITY_YAW_RATE & ~64 | 512}, "forces are not simulated"),
        ({"frame": LOCAL_NED, "mask": POSITION_YAW, "xyz": (3e38, 0, 0)}, "out of range"),
        ({"frame": LOCAL_NED, "mask": VELOCITY_YAW_RATE & ~64, "a": (NAN, 0, 0)}, "not a finite number"),
        ({"frame": BODY_NED, "mask": POSITION_YAW}, "positions in BODY_NED"),
    ],
)
def test_a_setpoint_that_cannot_be_flown_is_refused_and_is_no_stream(fields, why):
    wire = Wire().take_off()
    wire.setpoint(**fields)
    wire.run(DT)
    assert any(why in text for text in wire.texts())
    assert wire.command(m.MAV_CMD_DO_SET_MODE, 1, 6, 0) == m.MAV_RESULT_TEMPORARILY_REJECTED


def test_what_the_mask_ignores_may_be_anything():
    wire = Wire().take_off()
    wire.fly(1.0, BODY_NED, VELOCITY_YAW_RATE, xyz=(NAN,) * 3, v=(1.0, 0.0, 0.0), a=(NAN,) * 3, yaw=NAN)
    assert wire.sim.v[0] == pytest.approx(1.0)


def test_a_setpoint_gone_bad_in_flight_counts_as_lost():
    wire = Wire().take_off().fly(1.0, BODY_NED, VELOCITY_YAW_RATE, v=(1.0, 0.0, 0.0))
    wire.run(1.1, lambda: wire.setpoint(BODY_NED, VELOCITY_YAW_RATE, v=(NAN, 0, 0)))
    assert wire.sim.autopilot.mode is not Mode.OFFBOARD
    assert all(math.isfinite(value) for value in (*wire.sim.p, *wire.sim.v))


def test_offboard_is_lost_one_second_after_the_last_setpoint():
    wire = Wire().take_off()
    assert wire.sim.autopilot.parameters.set("COM_OBL_RC_ACT", 5)
    wire.fly(1.0, BODY_NED, VELOCITY_YAW_RATE, v=(1.0, 0.0, 0.0))
    wire.run(0.97)
    assert wire.sim.autopilot.mode is Mode.OFFBOARD
    wire.run(0.06)
    assert wire.sim.autopilot.mode is Mode.HOLD
    wire.run(2.1)
    assert wire.newest("HEARTBEAT").system_status == m.MAV_STATE_CRITICAL
    assert wire.newest("HEARTBEAT").custom_mode == 4 << 16 | 3 << 24
    assert wire.heard_mode() == (4 << 16 | 3 << 24, 6 << 16)


def test_accelerations_are_followed():
    wire = Wire().take_off()
    mask = 0xFFF & ~(64 | 128 | 256 | 512 | 2048)
    wire.fly(2.0, LOCAL_NED, mask, a=(0.5, 0.0, 0.0))
    assert wire.sim.v[1] == pytest.approx(1.0, abs=0.1)


def test_a_place_on_the_globe_is_flown_to():
    wire = Wire().take_off()
    latitude, longitude, _ = frames.geodetic(5.0, -3.0, 0.0)

    def send(frame=6, height=4.0, mask=POSITION_YAW):
        place = (round(latitude * 1e7), round(longitude * 1e7), height)
        wire.send(
            m.MAVLink_set_position_target_global_int_message(
                0, 1, 1, frame, mask, *place, *[0.0] * 6, math.radians(90), 0.0
            )
        )

    send()
    assert wire.command(m.MAV_CMD_DO_SET_MODE, 1, 6, 0) == m.MAV_RESULT_ACCEPTED
    wire.run(12.0, send)
    assert wire.sim.p == pytest.approx((5.0, -3.0, 4.0, 0.0), abs=0.1)
    wire.run(4.0, lambda: send(5, 488.0 + 6.0))
    assert wire.sim.p[2] == pytest.approx(6.0, abs=0.2)
    told = wire.newest("POSITION_TARGET_GLOBAL_INT")
    assert told.lat_int == pytest.approx(round(latitude * 1e7), abs=1)
    assert wire.newest("POSITION_TARGET_LOCAL_NED").z == pytest.approx(-6.0)
    for bad in ({"frame": 1}, {"height": NAN}):
        send(**bad)
    wire.run(DT)
    assert "Setpoint refused: frame 1 is not GLOBAL_INT or GLOBAL_RELATIVE_ALT_INT" in wire.texts()


def test_setpoints_of_other_kinds_are_refused():
    wire = Wire()
    wire.send(m.MAVLink_set_attitude_target_message(0, 1, 1, 0, (1, 0, 0, 0), 0, 0, 0, 0.5))
    wire.run(DT)
    assert wire.texts()[-1] == "Setpoint refused: SET_ATTITUDE_TARGET is not simulated"
