"""MAVProxy 1.8.75, headless and unmodified, against `python -m sim`: arm, modes, take-off, parameters, mission, tlog.

On a PX4 its `mode NAME` fails before anything is sent: it hands pymavlink the tuple (base, main, sub mode) where one
number is expected. PX4's users give `long MAV_CMD_DO_SET_MODE 157 MAIN SUB` there, and so does this test.
"""

import re
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pymavlink import mavutil

from sim import frames
from sim.autopilot.parameters import NAMES

pytestmark = [pytest.mark.flight, pytest.mark.timeout(300)]
PATIENCE_S, TRIES = 60.0, 4
HOLD = "157 4 3"


def mission_text():
    lines = ["QGC WPL 110"]
    for seq, (frame, command, east, north, height) in enumerate(
        [(3, 22, 0, 0, 5), (3, 16, 8, 0, 5), (3, 16, 8, 6, 6), (2, 20, None, None, 0)]
    ):
        latitude, longitude, _ = (0.0, 0.0, 0.0) if east is None else frames.geodetic(east, north, 0.0)
        lines.append(
            f"{seq}\t{int(seq == 0)}\t{frame}\t{command}\t0\t0\t0\t0\t{latitude:.7f}\t{longitude:.7f}\t{height}\t1"
        )
    return "\n".join(lines) + "\n"


class MavProxy:
    """MAVProxy on pipes, and the vehicle it flies."""

    def __init__(self, folder):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.folder, self.tlog, self.log = folder, folder / "flight.tlog", folder / "said.txt"
        url = f"udpout://127.0.0.1:{port}"
        vehicle = ("-m", "sim", "--quiet", "--with-parent", "--speed", "3", "--connect", url)
        self.vehicle = subprocess.Popen([sys.executable, *vehicle])
        script = Path(sys.executable).with_name("mavproxy.py")
        options = (f"--master=udpin:127.0.0.1:{port}", f"--state-basedir={folder}", f"--logfile={self.tlog}")
        with self.log.open("wb") as output:
            self.process = subprocess.Popen(
                [sys.executable, "-u", str(script), *options],
                stdin=subprocess.PIPE,
                stdout=output,
                stderr=subprocess.STDOUT,
                cwd=folder,
                text=True,
            )
        self.seen = 0

    def hear(self, pattern, patience=PATIENCE_S):
        """Wait until it says something new that matches; None if it does not in time."""
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline:
            if found := re.compile(pattern).search(self.said(), self.seen):
                self.seen = found.end()
                return found
            assert self.process.poll() is None, self.said()
            time.sleep(0.05)
        return None

    def expect(self, *patterns):
        for pattern in patterns:
            assert self.hear(pattern), f"not heard: {pattern}\n{self.said()}"

    def do(self, command, *patterns):
        """Give a command until it says what it should; its prompt is the flight mode.

        It sends commands once only, and a busy machine drops datagrams: then its user gives the command again.
        """
        for _ in range(TRIES):
            self.process.stdin.write(command + "\n")
            self.process.stdin.flush()
            if all(self.hear(pattern, PATIENCE_S / TRIES) for pattern in patterns):
                return
        pytest.fail(f"not heard after {command!r}: {patterns}\n{self.said()}")

    def said(self):
        return self.log.read_text(encoding="utf-8", errors="replace")

    def close(self):
        for process in (self.process, self.vehicle):
            process.terminate()
            process.communicate()


@pytest.fixture
def mavproxy(tmp_path):
    mavproxy = MavProxy(tmp_path)
    yield mavproxy
    mavproxy.close()


def test_it_arms_flies_plans_and_writes_its_log(mavproxy):
    mavproxy.expect("Detected vehicle 1:1", rf"Saved {len(NAMES)} parameters")
    mavproxy.do("param set MIS_TAKEOFF_ALT 3.5")
    told = ""
    while told != "3.5":
        # It sets parameters in its own good time.
        mavproxy.do("param fetch MIS_TAKEOFF_ALT", "MIS_TAKEOFF_ALT = ")
        told = mavproxy.hear(r"\d\.\d")[0]

    mavproxy.do("arm throttle", "COMPONENT_ARM_DISARM: ACCEPTED", "ARMED")
    mavproxy.do(
        "takeoff 5",
        "NAV_TAKEOFF: ACCEPTED",
        r"minimum takeoff altitude: 3\.50 m",
        "TAKEOFF>",
        "LOITER>",
    )
    mavproxy.do("disarm", "COMPONENT_ARM_DISARM: TEMPORARILY_REJECTED", "Disarming denied: not landed")
    mavproxy.do("long MAV_CMD_NAV_RETURN_TO_LAUNCH", "NAV_RETURN_TO_LAUNCH: ACCEPTED", "RTL>")
    mavproxy.do(f"long MAV_CMD_DO_SET_MODE {HOLD}", "DO_SET_MODE: ACCEPTED", "LOITER>")

    plan, back = mavproxy.folder / "plan.txt", mavproxy.folder / "back.txt"
    plan.write_text(mission_text(), encoding="utf-8")
    mavproxy.do(f"wp load {plan}", "Sent all 4 waypoints", "MISSION_ACK: TYPE_MISSION: ACCEPTED")
    mavproxy.do(f"wp save {back}", "Saved 4 waypoints")
    assert numbers(back) == pytest.approx(numbers(plan), abs=1e-6)
    mavproxy.do("long MAV_CMD_MISSION_START 0 3", "MISSION_START: ACCEPTED", "MISSION>")
    mavproxy.expect("RTL>", "DISARMED")
    mavproxy.do("wp clear", "MISSION_ACK: TYPE_MISSION: ACCEPTED")
    mavproxy.do("reboot", "REBOOT_SHUTDOWN: ACCEPTED")
    mavproxy.close()
    assert_logged(mavproxy.tlog)


def numbers(path):
    return [
        float(word) for line in path.read_text(encoding="utf-8").splitlines()[1:] for word in line.split()
    ]


def assert_logged(path):
    """Its log is read by pymavlink and holds the flight."""
    log = mavutil.mavlink_connection(str(path))
    highest, modes, kinds = 0.0, set(), set()
    while (message := log.recv_match()) is not None:
        kinds.add(message.get_type())
        if message.get_type() == "LOCAL_POSITION_NED":
            highest = max(highest, -message.z)
        if message.get_type() == "HEARTBEAT" and message.get_srcComponent() == 1:
            modes.add(log.flightmode)
    log.close()
    assert highest > 4.5
    assert {"TAKEOFF", "LOITER", "MISSION", "RTL"} <= modes
    assert {"PARAM_VALUE", "MISSION_ACK", "MISSION_ITEM_REACHED", "STATUSTEXT", "SYS_STATUS"} <= kinds
