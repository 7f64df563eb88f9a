"""A real MAVSDK flies the simulated vehicle: what a ground station built on it finds, signs of all axes included."""

import contextlib
import math
import socket
import subprocess
import sys
import time

import pytest
from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.logging import log_subscribe, log_unsubscribe
from mavsdk.plugins.action import Action, ActionError
from mavsdk.plugins.offboard import Offboard, OffboardError, PositionNedYaw, VelocityBodyYawspeed
from mavsdk.plugins.param import Param
from mavsdk.plugins.telemetry import FlightMode, LandedState, Telemetry
from pymavlink.dialects.v20 import common as m

from sim.mavlink.wire import Inbox

pytestmark = pytest.mark.flight

# North-east, as the mission has it: 60° counter-clockwise from east is a heading of 30°.
YAW_DEG, HEADING_DEG = 60.0, 30.0
MISSION = f"""
schema = 1
name = "test"
title = "test"
[vehicle]
airframe = "x500"
model = "dynamic"
yaw_deg = {YAW_DEG}
"""


def wait_until(condition, what, patience=40.0):
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.02)
    pytest.fail(f"not within {patience} s: {what}")


@pytest.fixture(scope="module", autouse=True)
def silence():
    log_subscribe(lambda *_: True)
    yield
    log_unsubscribe()


@pytest.fixture
def port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


@pytest.fixture
def vehicle(port, tmp_path):
    mission = tmp_path / "mission.toml"
    mission.write_text(MISSION, encoding="utf-8")
    url = f"udpout://127.0.0.1:{port}"
    options = ("--connect", url, "--mission", str(mission), "--quiet", "--with-parent", "--speed", "3")
    process = subprocess.Popen([sys.executable, "-m", "sim", *options])
    yield process
    process.terminate()
    assert process.wait(20) == 0


class Pilot:
    """MAVSDK, connected."""

    def __init__(self, port):
        self.mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
        self.mavsdk.add_any_connection(f"udpin://127.0.0.1:{port}")
        system = self.mavsdk.first_autopilot(20.0)
        assert system is not None
        self.telemetry, self.action = Telemetry(system), Action(system)
        self.offboard, self.param = Offboard(system), Param(system)
        self.texts = []
        self.telemetry.subscribe_status_text(lambda text, *_: self.texts.append(text.text))

    def place(self):
        position = self.telemetry.position_velocity_ned().position
        return position.north_m, position.east_m, position.down_m

    def mode_is(self, mode):
        return lambda: self.telemetry.flight_mode() == mode

    def take_off(self, height):
        wait_until(lambda: self.telemetry.health().is_armable, "armable")
        self.action.set_takeoff_altitude(height)
        self.action.arm()
        self.action.takeoff()
        wait_until(lambda: abs(self.place()[2] + height) < 0.2, "at height")
        wait_until(lambda: self.telemetry.landed_state() == LandedState.IN_AIR, "in the air")
        wait_until(self.mode_is(FlightMode.HOLD), "hold after take-off")


@pytest.fixture
def pilot(port, vehicle):
    pilot = Pilot(port)
    yield pilot
    pilot.mavsdk.destroy()


def test_it_is_found_healthy_on_the_ground(pilot):
    telemetry = pilot.telemetry
    wait_until(lambda: telemetry.health().is_armable, "armable")
    health = telemetry.health()
    assert health.is_local_position_ok
    assert health.is_global_position_ok
    wait_until(lambda: telemetry.health().is_home_position_ok, "home")
    assert not telemetry.in_air()
    wait_until(lambda: telemetry.battery().voltage_v > 10.0, "battery")
    wait_until(lambda: telemetry.gps_info().num_satellites > 6, "gps")


def test_a_whole_flight(pilot, port):
    telemetry, offboard = pilot.telemetry, pilot.offboard
    pilot.take_off(3.0)
    assert telemetry.in_air()
    assert telemetry.armed()
    assert telemetry.attitude_euler().yaw_deg == pytest.approx(HEADING_DEG, abs=0.5)

    north, east, down = pilot.place()
    offboard.set_velocity_body(VelocityBodyYawspeed(1.0, 0.0, 0.0, 0.0))
    offboard.start()
    wait_until(pilot.mode_is(FlightMode.OFFBOARD), "offboard")
    wait_until(lambda: math.dist(pilot.place(), (north, east, down)) > 2.0, "moved forward")
    moved_north, moved_east, moved_down = (
        a - b for a, b in zip(pilot.place(), (north, east, down), strict=True)
    )
    assert math.degrees(math.atan2(moved_east, moved_north)) == pytest.approx(HEADING_DEG, abs=3.0)
    assert abs(moved_down) < 0.3

    offboard.set_velocity_body(VelocityBodyYawspeed(0.0, 1.0, 0.0, 0.0))
    time.sleep(2.0)
    north, east, down = pilot.place()
    wait_until(lambda: math.dist(pilot.place(), (north, east, down)) > 2.0, "moved right")
    moved_north, moved_east, _ = (a - b for a, b in zip(pilot.place(), (north, east, down), strict=True))
    assert math.degrees(math.atan2(moved_east, moved_north)) == pytest.approx(HEADING_DEG + 90.0, abs=5.0)

    offboard.set_velocity_body(VelocityBodyYawspeed(0.0, 0.0, 0.0, 30.0))
    wait_until(lambda: telemetry.attitude_euler().yaw_deg > HEADING_DEG + 20.0, "turned right")
    offboard.set_velocity_body(VelocityBodyYawspeed(0.0, 0.0, 0.5, 0.0))
    wait_until(lambda: pilot.place()[2] > -2.0, "sank")

    offboard.set_velocity_body(VelocityBodyYawspeed(1.0, 0.0, 0.0, 0.0))
    time.sleep(1.0)
    pilot.mavsdk.destroy()
    holds_and_lands_by_itself(port)


class Listener:
    """A plain socket in the place of the ground station that has gone; keeps the newest of each message."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        self.socket.setblocking(False)
        self.inbox, self.packer = Inbox(), m.MAVLink(None, srcSystem=245, srcComponent=190)
        self.heard, self.peer = {}, None

    def newest(self, kind):
        with contextlib.suppress(BlockingIOError):
            while True:
                data, self.peer = self.socket.recvfrom(65536)
                self.heard.update({x.get_type(): x for x in self.inbox.messages(data, whole=True)})
        return self.heard.get(kind)

    def wait(self, kind, condition, what):
        wait_until(lambda: self.newest(kind) is not None and condition(self.newest(kind)), what)


def holds_and_lands_by_itself(port):
    """The ground station is gone without a word: hold; then a plain command lands the vehicle and it disarms."""
    listener = Listener(port)
    listener.wait("HEARTBEAT", lambda x: x.custom_mode == 4 << 16 | 3 << 24, "hold after the stream was lost")
    listener.wait("LOCAL_POSITION_NED", lambda x: math.hypot(x.vx, x.vy, x.vz) < 0.1, "at rest")
    land = m.MAVLink_command_long_message(1, 1, m.MAV_CMD_NAV_LAND, 0, *[math.nan] * 7)
    listener.socket.sendto(land.pack(listener.packer), listener.peer)
    listener.wait("EXTENDED_SYS_STATE", lambda x: x.landed_state == 1, "landed")
    listener.wait("HEARTBEAT", lambda x: not x.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED, "disarmed")
    listener.socket.close()


def test_refusals_come_with_their_reason(pilot):
    pilot.take_off(2.0)
    with pytest.raises(ActionError):
        pilot.action.disarm()
    wait_until(lambda: "Disarming denied: not landed" in pilot.texts, "the reason")
    with pytest.raises(OffboardError):
        pilot.offboard.start()


def test_parameters_and_positions(pilot):
    pilot.param.set_param_int("COM_OBL_RC_ACT", 4)
    assert pilot.param.get_param_int("COM_OBL_RC_ACT") == 4
    assert pilot.param.get_param_float("COM_OF_LOSS_T") == 1.0
    everything = pilot.param.get_all_params()
    assert {param.name for param in everything.int_params} >= {"COM_OBL_RC_ACT", "NAV_DLL_ACT"}
    assert {param.name for param in everything.float_params} >= {"MIS_TAKEOFF_ALT", "MPC_XY_VEL_MAX"}

    pilot.take_off(2.0)
    pilot.offboard.set_position_ned(PositionNedYaw(2.0, -1.0, -3.0, 90.0))
    pilot.offboard.start()
    wait_until(lambda: math.dist(pilot.place(), (2.0, -1.0, -3.0)) < 0.1, "position reached")
    wait_until(lambda: abs(pilot.telemetry.attitude_euler().yaw_deg - 90.0) < 2.0, "yaw reached")
    pilot.offboard.stop()
    wait_until(pilot.mode_is(FlightMode.HOLD), "hold")
    pilot.telemetry.set_rate_position_velocity_ned(100.0)
    pilot.action.return_to_launch()
    wait_until(pilot.mode_is(FlightMode.RETURN_TO_LAUNCH), "return")
    wait_until(lambda: not pilot.telemetry.armed(), "home and disarmed", patience=60.0)
    assert math.hypot(*pilot.place()[:2]) < 0.5


def test_a_kill_falls(pilot):
    pilot.take_off(2.0)
    pilot.action.kill()
    wait_until(lambda: not pilot.telemetry.armed(), "disarmed")
    wait_until(lambda: "Collision with floor" in pilot.texts, "the fall's end")
