"""What the simulated vehicle tells of itself: rates, signs, frames."""

import itertools
import math
from collections import Counter

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import BODY_NED, DT, LOCAL_NED, NAN, VELOCITY_YAW_RATE, AllFrames, Wire

from sim import frames
from sim.mavlink.dialect import CURRENT_MODE
from sim.mavlink.streams import ONBOARD_RATES
from sim.scenario import Box, EstimateChoice, Wind


def test_the_first_step_says_who_it_is():
    heartbeat = Wire().run(DT)[0]
    assert heartbeat.get_type() == "HEARTBEAT"
    assert (heartbeat.get_srcSystem(), heartbeat.get_srcComponent()) == (1, 1)
    assert heartbeat.autopilot == m.MAV_AUTOPILOT_PX4
    assert heartbeat.custom_mode == 4 << 16 | 3 << 24
    assert heartbeat.base_mode & m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    assert not heartbeat.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED


# Told only while there is a target.
WHILE_ARMED = {
    m.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED,
    m.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT,
    m.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
}
# Not in pymavlink's dialect; MAVSDK's knows it.
UNKNOWN = {CURRENT_MODE}


def test_default_rates_are_kept_and_sequence_numbers_have_no_gap():
    wire = Wire()
    wire.inbox = AllFrames()
    heard = wire.take_off().run(10.0)
    counts = Counter(message.get_msgId() for message in heard)
    for message_id, rate in ONBOARD_RATES.items():
        assert counts[message_id] == pytest.approx(10.0 * rate, abs=1), message_id
    numbers = [message.get_seq() for message in heard]
    assert all((b - a) % 256 == 1 for a, b in itertools.pairwise(numbers))


@pytest.mark.parametrize(
    ("interval_us", "rate"),
    [(20_000, 50), (4_000, 250), (1, 250), (1e6, 1), (-1, 0), (0, 30), (3e38, 1 / 2147)],
)
def test_an_interval_asked_for_is_kept(interval_us, rate):
    wire = Wire()
    assert wire.command(m.MAV_CMD_SET_MESSAGE_INTERVAL, 32, interval_us) == m.MAV_RESULT_ACCEPTED
    heard = wire.run(4.0)
    assert sum(message.get_msgId() == 32 for message in heard) == pytest.approx(4 * rate, abs=1)
    answer = wire.ask(
        m.MAVLink_command_long_message(1, 1, m.MAV_CMD_GET_MESSAGE_INTERVAL, 0, 32, 0, 0, 0, 0, 0, 0),
        "MESSAGE_INTERVAL",
    )
    assert answer.interval_us == pytest.approx(1e6 / rate if rate else -1, abs=1, rel=1e-6)


def test_a_message_by_itself_can_be_asked_for():
    wire = Wire()
    wire.run(1)
    assert wire.command(m.MAV_CMD_REQUEST_MESSAGE, 148) == m.MAV_RESULT_ACCEPTED
    version = wire.newest("AUTOPILOT_VERSION")
    assert version.capabilities & m.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    assert version.capabilities & m.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    assert version.capabilities & m.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    assert version.capabilities & m.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    assert not version.capabilities & m.MAV_PROTOCOL_CAPABILITY_FTP
    assert wire.command(m.MAV_CMD_REQUEST_MESSAGE, 264) == m.MAV_RESULT_ACCEPTED
    assert wire.newest("FLIGHT_INFORMATION").arming_time_utc == 0
    for unknown in (55555, NAN, 0.5):
        assert wire.command(m.MAV_CMD_REQUEST_MESSAGE, unknown) == m.MAV_RESULT_DENIED


def test_every_message_there_is_can_be_built_on_the_ground_and_in_flight():
    wire = Wire("dynamic", wind=Wind(mean=(1.0, 2.0, 0.1)))
    for _ in range(2):
        there = {*ONBOARD_RATES, 148, 264} - (set() if wire.sim.autopilot.armed else WHILE_ARMED)
        for message_id in sorted(there):
            assert wire.command(m.MAV_CMD_REQUEST_MESSAGE, message_id) == m.MAV_RESULT_ACCEPTED
            assert message_id in UNKNOWN or any(x.get_msgId() == message_id for x in wire.heard[-60:])
        if not wire.sim.autopilot.armed:
            wire.take_off()


def test_health_says_armable_until_it_is_not():
    wire = Wire()
    wire.run(1)
    assert wire.newest("SYS_STATUS").onboard_control_sensors_health & m.MAV_SYS_STATUS_PREARM_CHECK
    wire.sim.battery.remaining = 0.02
    wire.run(1)
    status = wire.newest("SYS_STATUS")
    assert status.battery_remaining == 2
    assert not status.onboard_control_sensors_health & m.MAV_SYS_STATUS_PREARM_CHECK
    assert wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0) == m.MAV_RESULT_TEMPORARILY_REJECTED
    wire.run(DT)
    assert "Arming denied: battery at 2%; charge it" in wire.texts()


@pytest.mark.parametrize(("yaw_deg", "heading_deg"), [(0, 90), (90, 0), (180, -90), (-90, 180), (45, 45)])
def test_the_heading_is_clockwise_from_north(yaw_deg, heading_deg):
    wire = Wire(yaw_deg=yaw_deg)
    wire.run(1)
    wanted = math.radians(heading_deg)
    assert math.cos(wire.newest("ATTITUDE").yaw - wanted) == pytest.approx(1.0, abs=1e-6)
    q = wire.newest("ATTITUDE_QUATERNION")
    assert math.cos(2 * math.atan2(q.q4, q.q1) - wanted) == pytest.approx(1.0, abs=1e-6)
    assert wire.newest("GLOBAL_POSITION_INT").hdg == pytest.approx(heading_deg % 360 * 100, abs=1)
    assert wire.newest("VFR_HUD").heading == heading_deg % 360


def test_forward_flight_is_nose_down_and_right_is_right_side_down():
    wire = Wire("dynamic", yaw_deg=90.0).take_off()
    wire.fly(0.4, BODY_NED, VELOCITY_YAW_RATE, v=(2.0, 0.0, 0.0))
    assert wire.newest("ATTITUDE").pitch < -0.1
    assert abs(wire.newest("ATTITUDE").roll) < 0.01
    wire.fly(1.0, BODY_NED, VELOCITY_YAW_RATE, v=(0.0, 3.0, 0.0))
    assert wire.newest("ATTITUDE").roll > 0.1


def test_at_rest_the_accelerometer_feels_gravity_upward():
    wire = Wire()
    wire.run(1)
    imu = wire.newest("HIGHRES_IMU")
    assert (imu.xacc, imu.yacc, imu.zacc) == pytest.approx((0.0, 0.0, -9.807), abs=0.06)
    assert math.hypot(imu.xmag, imu.ymag, imu.zmag) == pytest.approx(0.48, abs=0.01)


def test_odometry_position_and_globe_agree():
    wire = Wire().take_off().fly(2.0, LOCAL_NED, VELOCITY_YAW_RATE, v=(1.0, 0.5, -0.2))
    wire.run(0.1)
    x, y, z, _ = wire.sim.p
    local, globe = wire.newest("LOCAL_POSITION_NED"), wire.newest("GLOBAL_POSITION_INT")
    assert (local.x, local.y, local.z) == pytest.approx((y, x, -z), abs=0.1)
    east, north = frames.local(globe.lat * 1e-7, globe.lon * 1e-7)
    assert (north, east, globe.relative_alt * 1e-3) == pytest.approx((y, x, z), abs=0.1)
    odometry = wire.newest("ODOMETRY")
    assert (odometry.x, odometry.y) == pytest.approx((y, x), abs=0.1)


def test_geodetic_and_local_are_inverse():
    latitude, longitude, height = frames.geodetic(120.0, -80.0, 5.0)
    assert frames.local(latitude, longitude) == pytest.approx((120.0, -80.0), abs=1e-6)
    assert height == 493.0


def test_the_rangefinder_sees_what_is_below():
    wire = Wire(obstacle=(Box("crate", (0.0, 3.0, 0.5), (2.0, 2.0, 1.0)),)).take_off()
    wire.run(0.2)
    height = wire.sim.p[2]
    assert wire.newest("DISTANCE_SENSOR").current_distance == pytest.approx(100 * height, abs=2)
    wire.fly(3.0, LOCAL_NED, VELOCITY_YAW_RATE, v=(1.0, 0.0, 0.0))
    assert wire.newest("DISTANCE_SENSOR").current_distance == pytest.approx(100 * (height - 1.0), abs=2)


def test_the_same_seed_gives_the_same_bytes():
    def spoken(seed):
        wire = Wire(seed=seed)
        return [message.get_msgbuf() for message in wire.run(2.0)]

    assert spoken(5) == spoken(5)
    assert spoken(5) != spoken(6)


def test_the_ring_of_rangefinders_looks_clockwise_from_ahead():
    """Facing north: a wall east of the vehicle is on its right, a quarter of the way round."""
    wire = Wire(yaw_deg=90.0, obstacle=(Box("wall", (5.0, 0.0, 2.0), (1.0, 6.0, 4.0)),)).take_off()
    wire.run(0.2)
    ring = wire.newest("OBSTACLE_DISTANCE")
    assert (ring.frame, ring.increment, ring.angle_offset) == (m.MAV_FRAME_BODY_FRD, 5, 0.0)
    assert ring.distances[18] == pytest.approx(450, abs=2)
    assert ring.distances[0] == ring.distances[54] == ring.max_distance + 1


def test_motion_is_told_as_the_vehicle_believes_it_and_sensors_measure_the_truth():
    wire = Wire("dynamic", seed=4, estimate=EstimateChoice("gps")).take_off()
    wire.run(60.0)
    told, believed = wire.newest("LOCAL_POSITION_NED"), wire.sim.estimate.p
    assert (told.y, told.x, -told.z) == pytest.approx(believed[:3], abs=0.05)
    assert math.dist(believed[:3], wire.sim.p[:3]) > 0.05
    below = wire.newest("DISTANCE_SENSOR").current_distance * 1e-2
    assert below == pytest.approx(wire.sim.p[2], abs=0.03)
    gps = wire.newest("GPS_RAW_INT")
    assert (gps.h_acc, gps.v_acc) == (400, 800)
    assert 45 <= wire.newest("VFR_HUD").throttle <= 55
