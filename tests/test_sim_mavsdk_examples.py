"""Programs after MAVSDK's Python examples, against `python -m sim`: telemetry, mission, geofence, offboard by place.

Take-off and land, parameters and offboard velocities are in test_sim_mavsdk.py.
"""

import contextlib
import math
import socket
import subprocess
import sys
import time

import pytest
from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.logging import log_subscribe, log_unsubscribe
from mavsdk.plugins.action import Action
from mavsdk.plugins.geofence import Circle, FenceType, Geofence, GeofenceData, Point, Polygon
from mavsdk.plugins.info import Info
from mavsdk.plugins.mission import Mission, MissionError, MissionItem, MissionPlan
from mavsdk.plugins.offboard import Offboard, PositionNedYaw
from mavsdk.plugins.param import Param
from mavsdk.plugins.telemetry import FixType, FlightMode, LandedState, Telemetry

from sim import frames

pytestmark = pytest.mark.flight


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
def drone():
    """A vehicle at three times the usual pace, and MAVSDK connected to it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    url = f"udpout://127.0.0.1:{port}"
    options = ("--quiet", "--with-parent", "--airframe", "x500", "--speed", "3", "--connect", url)
    process = subprocess.Popen([sys.executable, "-m", "sim", *options])
    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    mavsdk.add_any_connection(f"udpin://127.0.0.1:{port}")
    system = mavsdk.first_autopilot(20.0)
    assert system is not None
    yield system
    mavsdk.destroy()
    process.terminate()
    assert process.wait(20) == 0


def place(east, north):
    latitude, longitude, _ = frames.geodetic(east, north, 0.0)
    return latitude, longitude


def item(east, north, height, **fields):
    latitude, longitude = place(east, north)
    return MissionItem(latitude, longitude, height, speed_m_s=5.0, is_fly_through=False, **fields)


def test_telemetry(drone):
    telemetry, info = Telemetry(drone), Info(drone)
    wait_until(telemetry.health_all_ok, "health")
    wait_until(lambda: telemetry.gps_info().fix_type == FixType.FIX_3D, "fix")
    wait_until(lambda: abs(telemetry.position().latitude_deg - frames.ORIGIN[0]) < 1e-5, "position")
    wait_until(lambda: telemetry.battery().remaining_percent > 90.0, "battery")
    wait_until(lambda: abs(telemetry.heading().heading_deg - 90.0) < 1.0, "heading")
    wait_until(lambda: telemetry.imu().acceleration_frd.down_m_s2 < -9.0, "imu")
    wait_until(lambda: abs(telemetry.home().absolute_altitude_m - frames.ORIGIN[2]) < 0.5, "home")
    wait_until(lambda: telemetry.odometry().q.w != 0.0, "odometry")
    wait_until(lambda: abs(telemetry.altitude().altitude_relative_m) < 0.5, "altitude")
    wait_until(lambda: 0.0 <= telemetry.distance_sensor().current_distance_m < 0.5, "rangefinder")
    wait_until(lambda: telemetry.landed_state() == LandedState.ON_GROUND, "landed")
    assert info.get_version().flight_sw_major == 1
    assert math.isfinite(telemetry.get_gps_global_origin().latitude_deg)


def test_mission(drone):
    telemetry, action, mission = Telemetry(drone), Action(drone), Mission(drone)
    wait_until(lambda: telemetry.health().is_armable, "armable")
    with pytest.raises(MissionError):
        mission.start_mission()
    plan = MissionPlan(
        [
            item(0.0, 0.0, 5.0),
            item(12.0, 0.0, 5.0, loiter_time_s=1.0),
            item(12.0, 8.0, 7.0, yaw_deg=0.0),
            item(0.0, 8.0, 5.0, camera_action=MissionItem.CameraAction.TAKE_PHOTO),
        ]
    )
    mission.set_return_to_launch_after_mission(True)
    mission.upload_mission(plan)
    back = mission.download_mission().mission_items
    assert [(x.latitude_deg, x.relative_altitude_m) for x in back] == [
        (pytest.approx(x.latitude_deg, abs=1e-6), x.relative_altitude_m) for x in plan.mission_items
    ]
    told = []
    mission.subscribe_mission_progress(lambda progress, *_: told.append((progress.current, progress.total)))
    action.arm()
    mission.start_mission()
    wait_until(lambda: telemetry.flight_mode() == FlightMode.MISSION, "mission mode")
    wait_until(lambda: any(current >= 2 for current, _ in told), "second item")
    mission.pause_mission()
    wait_until(lambda: telemetry.flight_mode() == FlightMode.HOLD, "paused")
    mission.start_mission()
    wait_until(mission.is_mission_finished, "finished", patience=60.0)
    assert told[-1][1] == 4
    wait_until(lambda: not telemetry.armed(), "home and disarmed", patience=90.0)
    mission.clear_mission()
    assert mission.download_mission().mission_items == []


def test_geofence(drone):
    telemetry, action, geofence, param = Telemetry(drone), Action(drone), Geofence(drone), Param(drone)
    wait_until(lambda: telemetry.health().is_armable, "armable")
    corners = [Point(*place(*corner)) for corner in ((-15, -15), (15, -15), (15, 15), (-15, 15))]
    circle = Circle(Point(*place(10, 10)), 2.0, FenceType.EXCLUSION)
    geofence.upload_geofence(GeofenceData([Polygon(corners, FenceType.INCLUSION)], [circle]))
    back = geofence.download_geofence()
    assert [len(polygon.points) for polygon in back.polygons] == [4]
    assert back.circles[0].radius == 2.0
    assert back.circles[0].point.latitude_deg == pytest.approx(place(10, 10)[0], abs=1e-6)
    param.set_param_int("GF_ACTION", 3)
    param.set_param_float("RTL_RETURN_ALT", 5.0)

    texts = []
    telemetry.subscribe_status_text(lambda text, *_: texts.append(text.text))
    action.arm()
    action.takeoff()
    wait_until(lambda: telemetry.position().relative_altitude_m > 2.0, "at height")
    offboard = Offboard(drone)
    offboard.set_position_ned(PositionNedYaw(0.0, 40.0, -4.0, 0.0))
    with contextlib.suppress(Exception):
        offboard.start()
    wait_until(lambda: telemetry.flight_mode() == FlightMode.RETURN_TO_LAUNCH, "turned back by the fence")
    wait_until(lambda: any("fence" in text.lower() for text in texts), "says so")
    wait_until(lambda: not telemetry.armed(), "home and disarmed", patience=90.0)
    geofence.clear_geofence()
    assert geofence.download_geofence().polygons == []


def test_offboard_by_place(drone):
    telemetry, action, offboard = Telemetry(drone), Action(drone), Offboard(drone)
    wait_until(lambda: telemetry.health().is_armable, "armable")
    action.arm()
    offboard.set_position_ned(PositionNedYaw(0.0, 0.0, 0.0, 0.0))
    offboard.start()

    def there(north, east, down):
        position = telemetry.position_velocity_ned().position
        return math.dist((position.north_m, position.east_m, position.down_m), (north, east, down)) < 0.4

    for target in ((0.0, 0.0, -5.0, 0.0), (5.0, 0.0, -5.0, 90.0), (5.0, 10.0, -5.0, 90.0)):
        offboard.set_position_ned(PositionNedYaw(*target))
        wait_until(lambda target=target: there(*target[:3]), f"at {target}")
    offboard.stop()
    wait_until(lambda: telemetry.flight_mode() == FlightMode.HOLD, "hold")
    action.land()
    wait_until(lambda: not telemetry.armed(), "landed and disarmed", patience=60.0)
