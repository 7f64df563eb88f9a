"""`groundstation preflight`: what it refuses, when it has looked long enough, and real vehicles, well and not."""

from __future__ import annotations

import json
import signal
import struct
import subprocess
import sys
import time

import pytest
from flight_support import headless, left_behind
from pymavlink import mavutil

from bench.rig import vehicle
from groundstation.cli import main
from groundstation.messages import Severity
from groundstation.preflight import Looking
from groundstation.processes import free_port
from groundstation.tui.check import Check
from groundstation.tui.checks_told import in_words, total

OK, CAUTION, DANGER = Severity.INFO, Severity.WARNING, Severity.ALARM
WELL, KNOWN = Check("link", OK, "heard"), Check("fence", CAUTION, "none set", "set one")
RED = Check("position", DANGER, "not told yet", "wait")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "say which, with --sim or --connect"),
        (("--connect", "carrier://pigeon"), "carrier"),
        (("--sim", "--wait", "-1"), "--wait"),
        (("--sim", "--wait", "nan"), "--wait"),
        (("--sim", "--mission", "nosuch"), "nosuch"),
        (("--sim", "--device", "nosuch"), "nosuch"),
        (("--connect", "udpin://127.0.0.1:1", "--airframe", "x500"), "a real vehicle brings its own"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(arguments, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main(["preflight", *arguments])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert words in said
    assert "Traceback" not in said


class Course:
    """Checks as they become, by virtual time."""

    def __init__(self, *stages: tuple[float, list[Check]]) -> None:
        self.stages, self.now = stages, 0.0

    def look(self) -> list[Check]:
        return [checks for since, checks in self.stages if since <= self.now][-1]

    def looked_until(self, wait_s: float) -> tuple[float, list[Check]]:
        looking = Looking(self.look, wait_s, lambda: self.now)
        while looking.turn():
            self.now += 0.05
        return self.now, looking.found


def test_it_ends_when_nothing_is_red_nor_changes():
    assert Course((0.0, [RED]), (2.0, [WELL])).looked_until(20.0) == (pytest.approx(5.0, abs=0.11), [WELL])


def test_what_is_red_is_waited_for_and_no_longer():
    assert Course((0.0, [RED]), (60.0, [WELL])).looked_until(20.0) == (pytest.approx(20.0, abs=0.11), [RED])


def test_what_turns_red_at_the_last_moment_counts():
    ended, found = Course((0.0, [RED]), (2.0, [WELL]), (4.0, [RED])).looked_until(20.0)
    assert ended == pytest.approx(20.0, abs=0.11)
    assert found == [RED]


def test_what_flutters_without_being_red_does_not_keep_it_for_ever():
    flutter = [(0.5 * turn, [WELL if turn % 2 else KNOWN]) for turn in range(200)]
    ended, _ = Course(*flutter).looked_until(5.0)
    assert ended == pytest.approx(8.0, abs=0.11)


def test_how_it_is_going_names_what_is_red():
    course = Course((0.0, [RED, WELL]))
    looking = Looking(course.look, 20.0, lambda: course.now)
    looking.turn()
    assert looking.words == "  0 s  1 to mend: position"


def test_the_total_and_the_text_say_all():
    assert total([WELL]) == "✓ all is well"
    assert total([WELL, KNOWN]) == "✓ may be flown   ▲ 1 to know of"
    assert total([RED, KNOWN]) == "■ 1 to mend before the flight   ▲ 1 to know of"
    text = in_words([RED, WELL], "Preflight, here, today")
    assert text.splitlines()[0] == "Preflight, here, today"
    assert "■ position" in text
    assert "→ wait" in text
    assert "→" not in text.splitlines()[-1]


def told(done: subprocess.CompletedProcess[str]) -> dict[str, dict[str, str]]:
    return {check["name"].partition(" =")[0]: check for check in json.loads(done.stdout)["checks"]}


@pytest.mark.flight
def test_a_vehicle_that_is_well_may_be_flown_and_nothing_of_it_is_left(tmp_path):
    done = headless("preflight", "--sim", "--json", "--logs", str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    found = told(done)
    assert json.loads(done.stdout)["may_be_flown"]
    assert found["vehicle"]["state"].startswith("system 1, component 1, PX4 ")
    assert found["COM_OF_LOSS_T"]["level"] == "ok"
    assert found["recording"]["state"].startswith(f"to {tmp_path}")
    assert list(tmp_path.iterdir()) == []


def disarms_when_setpoints_end(port: int) -> None:
    """Set COM_OBL_RC_ACT to 7 from another station."""
    station = mavutil.mavlink_connection(f"tcp:127.0.0.1:{port}", source_system=254)
    station.wait_heartbeat(timeout=10)
    (bits,) = struct.unpack("<f", struct.pack("<i", 7))
    station.mav.param_set_send(1, 1, b"COM_OBL_RC_ACT", bits, mavutil.mavlink.MAV_PARAM_TYPE_INT32)
    assert station.recv_match(type="PARAM_VALUE", blocking=True, timeout=5) is not None
    station.close()


@pytest.mark.flight
def test_a_dangerous_parameter_and_a_vehicle_that_is_not_there_are_told_with_exit_1(tmp_path):
    port, other = free_port(), free_port()
    url = f"udpin://127.0.0.1:{port}"
    with vehicle(port, "--connect", f"tcpin://{other}"):
        disarms_when_setpoints_end(other)
        done = headless("preflight", "--connect", url, "--json", "--wait", "6", "--logs", str(tmp_path))
        assert done.returncode == 1, done.stdout + done.stderr
        check = told(done)["COM_OBL_RC_ACT"]
        assert (check["level"], check["state"]) == ("danger", "Disarm")
        assert "set Hold, Return or Land" in check["remedy"]
    done = headless("preflight", "--connect", url, "--wait", "1", "--logs", str(tmp_path))
    assert done.returncode == 1
    assert f"■ link                    no vehicle at {url}" in done.stdout


@pytest.mark.flight
def test_ctrl_c_ends_it_with_130_and_nothing_is_left_behind(tmp_path):
    command = [sys.executable, "-m", "groundstation.cli", "preflight", "--sim", "--logs", str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    assert "Checking the vehicle" in process.stderr.readline()
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=30)
    assert process.returncode == 130
    assert out == ""
    assert left_behind(process.pid) == []
