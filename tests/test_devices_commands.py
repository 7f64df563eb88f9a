"""`groundstation devices`, as its user runs it: real processes, a Falcon's double on a pty, the screen of a test."""

import json
import os
import signal
import subprocess
import sys
import time
import tomllib

import pytest

from bench.rig import ROOT
from drivers.scripted import ScriptedHand
from groundstation.devices.loop import DeviceLoop
from groundstation.tui.device_test import DeviceTest


def run(*arguments, home, typed=""):
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", "devices", *arguments],
        capture_output=True, text=True, input=typed, cwd=ROOT, timeout=60, check=False,
        env=os.environ | {"XDG_CONFIG_HOME": str(home)},
    )  # fmt: skip


@pytest.fixture
def falcon(tmp_path):
    """A Falcon's double at rest, on a path of its own."""
    link = tmp_path / "falcon"
    command = ["devices", "emulate", "falcon", "--link", str(link)]
    process = subprocess.Popen(
        [sys.executable, "-m", "groundstation.cli", *command],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=ROOT,
    )  # fmt: skip
    assert f"--device falcon:{link}" in process.stdout.readline()
    yield link
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode == 0
    assert not link.is_symlink()


def test_the_list_says_what_cannot_be_used_and_why(tmp_path):
    listed = run("--json", home=tmp_path)
    assert listed.returncode == 0
    for device in json.loads(listed.stdout):
        assert device["usable"] or (device["why"] and device["remedy"])
    words = run(home=tmp_path)
    assert words.returncode == 0
    assert "falcon" in words.stdout


def test_the_emulators_are_listed(tmp_path):
    assert run("emulate", home=tmp_path).stdout.split() == ["falcon", "inverse3", "two-diy"]


def test_a_calibration_is_kept_and_forgotten(tmp_path, falcon):
    made = run("calibrate", f"falcon:{falcon}", home=tmp_path, typed="\n")
    assert made.returncode == 0, made.stderr
    file = tmp_path / "groundstation" / "devices" / "falcon-any.toml"
    assert str(file) in made.stdout
    kept = tomllib.loads(file.read_text())
    assert kept["scale"] == [1.0, 1.0, 1.0]
    assert all(abs(value) < 1e-3 for value in kept["center"])
    forgotten = run("calibrate", "falcon", "--forget", "", home=tmp_path)
    assert forgotten.returncode == 0
    assert not file.exists()
    assert run("calibrate", "falcon", "--forget", "", home=tmp_path).returncode == 2


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (("test", "theremin"), "no such haptic device"),
        (("test", "scripted:rest"), "terminal"),
        (("emulate", "theremin"), "no such emulator"),
        (("calibrate", "scripted:/nowhere/hand.sock"), "/nowhere"),
        (("emulate", "falcon", "--link", "/nowhere/at/all"), "cannot be made"),
        (("emulate", "inverse3", "--link", "/tmp/x"), "no file"),
        (("--config", "/nowhere.toml"), "/nowhere.toml"),
    ],
)
def test_what_is_wrong_is_one_sentence_and_exit_2(tmp_path, arguments, why):
    done = run(*arguments, home=tmp_path)
    assert done.returncode == 2, done.stderr
    assert why in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


async def test_the_screen_leads_through_a_trial():
    loop = DeviceLoop(ScriptedHand("rest"))
    loop.start()
    app = DeviceTest(loop)
    try:
        async with app.run_test(size=(80, 24)) as pilot:
            deadline = time.monotonic() + 20
            while app._trial is None:
                assert time.monotonic() < deadline
                await pilot.pause(0.05)
            await pilot.press("y")
            assert app.summary() == []
            await pilot.press("s", "s", "s", "s")
            await pilot.press("y", "n")
            loop_felt = loop.push(0.5)
            await pilot.press("y", "q")
        assert loop_felt[2] > 1.0
        assert app.return_value == 1
        assert app.summary() == [
            "forward: skipped", "left: skipped", "up: skipped", "turn left: skipped",
            "force forward: as it should be (felt)", "force left: wrong (not felt so)",
            "force up: as it should be (felt)",
        ]  # fmt: skip
    finally:
        loop.stop()
