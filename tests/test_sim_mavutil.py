"""pymavlink's `mavutil`, as scripts use it, against `python -m sim`."""

import socket
import subprocess
import sys
import time

import pytest
from pymavlink import mavutil, mavwp
from pymavlink.dialects.v20 import common as m

from sim import frames

pytestmark = pytest.mark.flight
PATIENCE_S = 40.0


@pytest.fixture
def link():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    link = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}", dialect="common")
    url = f"udpout://127.0.0.1:{port}"
    options = ("--quiet", "--with-parent", "--speed", "4", "--connect", url)
    process = subprocess.Popen([sys.executable, "-m", "sim", *options])
    yield link
    process.terminate()
    assert process.wait(20) == 0
    link.close()


def wait(link, kind, condition=lambda _: True):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        message = link.recv_match(type=kind, blocking=True, timeout=1.0)
        if message is not None and condition(message):
            return message
    pytest.fail(f"no {kind}")


def command(link, number, *params):
    link.mav.command_long_send(
        link.target_system, link.target_component, number, 0, *params, *[0] * (7 - len(params))
    )
    return wait(link, "COMMAND_ACK", lambda ack: ack.command == number).result


def upload(link, loader):
    link.mav.mission_count_send(link.target_system, link.target_component, loader.count())
    while True:
        message = wait(link, ["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"])
        if message.get_type() == "MISSION_ACK":
            return message.type
        link.mav.send(loader.wp(message.seq))


def test_a_script_connects_reads_plans_and_flies(link):
    link.wait_heartbeat(timeout=PATIENCE_S)
    assert link.target_system == 1
    assert link.flightmode == "LOITER"
    assert not link.motors_armed()

    link.param_fetch_all()
    count = wait(link, "PARAM_VALUE").param_count
    wait(link, "PARAM_VALUE", lambda _: len(link.params) == count)
    link.param_set_send("MIS_TAKEOFF_ALT", 3.0)
    wait(link, "PARAM_VALUE", lambda value: value.param_id == "MIS_TAKEOFF_ALT" and value.param_value == 3.0)

    loader = mavwp.MAVWPLoader(target_system=1, target_component=1)
    for command_, east, north, height in ((22, 0, 0, 4.0), (16, 6, 0, 4.0), (16, 6, 5, 5.0), (21, 0, 0, 0.0)):
        latitude, longitude, _ = frames.geodetic(east, north, 0.0)
        loader.add_latlonalt(latitude, longitude, height)
        loader.wp(loader.count() - 1).command = command_
    # A take-off, and the way down, on the spot they are given for.
    assert upload(link, loader) == m.MAV_MISSION_ACCEPTED
    link.waypoint_request_list_send()
    assert wait(link, "MISSION_COUNT").count == 4
    link.waypoint_request_send(2)
    back = wait(link, ["MISSION_ITEM", "MISSION_ITEM_INT"])
    assert (back.seq, back.command, back.z) == (2, 16, 5.0)

    link.arducopter_arm()
    assert wait(link, "COMMAND_ACK", lambda ack: ack.command == 400).result == m.MAV_RESULT_ACCEPTED
    wait(link, "HEARTBEAT", lambda _: link.motors_armed())
    link.set_mode("TAKEOFF")
    wait(link, "LOCAL_POSITION_NED", lambda position: position.z < -2.8)
    link.set_mode_auto()
    wait(link, "HEARTBEAT", lambda _: link.flightmode == "MISSION")
    wait(link, "MISSION_ITEM_REACHED", lambda reached: reached.seq == 2)
    link.set_mode_rtl()
    wait(link, "HEARTBEAT", lambda _: link.flightmode == "RTL")
    link.set_mode_loiter()
    wait(link, "HEARTBEAT", lambda _: link.flightmode == "LOITER")
    assert command(link, m.MAV_CMD_NAV_LAND) == m.MAV_RESULT_ACCEPTED
    wait(link, "HEARTBEAT", lambda _: not link.motors_armed())


def test_a_restart_begins_anew_and_keeps_the_parameters(link):
    link.wait_heartbeat(timeout=PATIENCE_S)
    link.param_set_send("MIS_TAKEOFF_ALT", 3.0)
    wait(link, "PARAM_VALUE")
    wait(link, "LOCAL_POSITION_NED", lambda position: position.time_boot_ms > 3000)
    link.reboot_autopilot()
    wait(link, "LOCAL_POSITION_NED", lambda position: position.time_boot_ms < 2000)
    link.param_fetch_one("MIS_TAKEOFF_ALT")
    assert wait(link, "PARAM_VALUE").param_value == 3.0


def test_signed_both_ways(tmp_path, link):
    key = bytes(range(32))
    link.wait_heartbeat(timeout=PATIENCE_S)
    link.mav.setup_signing_send(1, 1, list(key), 1)
    link.setup_signing(key, sign_outgoing=True)
    assert command(link, m.MAV_CMD_REQUEST_MESSAGE, 148) == m.MAV_RESULT_ACCEPTED
    assert wait(link, "AUTOPILOT_VERSION").get_signed()
