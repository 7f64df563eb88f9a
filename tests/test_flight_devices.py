"""Whole flights through devices' very bytes: missions by the doubles, and one pulled out in the air."""

import json
import math
import os
import signal
import struct
import time
from pathlib import Path

import pytest
from flight_support import LONG, descendants, headless, holds, speed, until

from bench.rig import Hand, Program, Tap, vehicle
from groundstation.messages import CommandKind, Phase

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]


@pytest.mark.parametrize("device", ["falcon", "inverse3", "two-diy"])
def test_a_mission_is_flown_through_a_devices_bytes(tmp_path, device):
    done = headless(
        "--sim", "--headless", "--mission", "hover", "--json", "--logs", str(tmp_path),
        "--device", f"emulated:{device}",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["completed"] is True
    assert summary["collisions"] == 0


def emulator_of(program) -> int:
    for pid in descendants(program.pids()["pilot"]):
        if "drivers.emulators" in Path(f"/proc/{pid}/cmdline").read_text():
            return pid
    return 0


def push(payload: bytes) -> float:
    """Return the speed a setpoint asks for, m/s."""
    return math.hypot(*struct.unpack_from("<3f", payload, 12))


@pytest.mark.parametrize("device", ["falcon", "inverse3", "two-diy"])
def test_a_device_pulled_out_in_flight_ends_in_hold_and_only_the_operator_engages_again(tmp_path, device):
    mission = tmp_path / "long.toml"
    mission.write_text(LONG)
    socket = str(tmp_path / "hand.sock")
    hand, tap = Hand(socket), Tap()
    with vehicle(tap.vehicle_port, "--mission", str(mission)):
        program = Program(
            "--connect", f"udpout://127.0.0.1:{tap.program_port}", "--device", f"emulated:{device}@{socket}",
            "--mission", str(mission), "--logs", str(tmp_path / "logs"),
        )  # fmt: skip
        try:
            view = program.until(lambda view: view.device and view.device.homed, 20, "the device is homed")
            program.engage()
            hand.put((0.6 * view.device.workspace, 0.0, 0.0))
            until(lambda: speed(tap) > 0.5, 10, "the vehicle follows the hand")
            pulled = time.monotonic()
            os.kill(emulator_of(program), signal.SIGKILL)
            program.until(lambda view: view.pilot.phase == Phase.DISENGAGED, 5, "uncoupled")
            until(lambda: holds(tap), 6, "the vehicle holds")
            moving = [t - pulled for t, payload in tap.setpoints if t > pulled and push(payload) > 0.05]
            print(f"last moving setpoint {1e3 * max(moving, default=0.0):.0f} ms after the cable was pulled")
            assert max(moving, default=0.0) < 0.1
            hand.put((0.0, 0.0, 0.0))
            program.until(lambda view: view.device.present and view.device.homed, 20, "plugged in again")
            time.sleep(0.5)
            view = program.console.snapshot()
            assert view.pilot.phase == Phase.DISENGAGED
            assert not any(view.handle.force)
            program.console.command(CommandKind.ENGAGE)
            program.until(lambda view: view.pilot.phase == Phase.ENGAGED, 10, "engaged by the operator")
        finally:
            program.close()
            hand.close()
            tap.close()
