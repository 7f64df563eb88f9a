"""What tests of whole flights share: the vehicle's side in words, what a run leaves behind, a stage for faults."""

import contextlib
import math
import os
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import common as mavlink

from bench.rig import ROOT, Hand, Program, Tap, hovers, vehicle
from groundstation.messages import CommandKind, Health, Phase

PX4_AUTO, PX4_LOITER, PX4_RETURN, PX4_LAND, PX4_OFFBOARD = 4, 3, 5, 6, 6
OURS = {"pilot", "link", "recorder"}
LONG = """
schema = 1
name = "long"
title = "A long stay in the air"
[target]
position = [0.0, 0.0, 2.0]
hold_s = 500.0
[criteria]
time_limit_s = 600.0
"""


def left_behind(pid: int) -> list[Path]:
    return [
        *Path("/dev/shm").glob(f"groundstation-{pid}-*"),
        *Path(tempfile.gettempdir()).glob(f"groundstation-{pid}-*"),
    ]


def gone(pid: int) -> bool:
    return not Path(f"/proc/{pid}").exists()


def descendants(pid: int) -> list[int]:
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if int((folder / "stat").read_text().rpartition(")")[2].split()[1]) == pid:
                found.append(int(folder.name))
        except (OSError, ValueError):
            continue
    return found


def until(condition, within_s, what):
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if result := condition():
            return result
        time.sleep(0.02)
    pytest.fail(f"within {within_s} s it did not happen: {what}")


def headless(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", *arguments],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        cwd=ROOT,
        timeout=170,
        check=False,
    )


def messages(datagrams, kind):
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    for t, data in datagrams:
        for message in parser.parse_buffer(data) or ():
            if message.get_type() == kind:
                yield t, message


def px4_mode(heartbeat) -> tuple[int, int]:
    return heartbeat.custom_mode >> 16 & 0xFF, heartbeat.custom_mode >> 24 & 0xFF


def speed(tap) -> float:
    found = [message for _, message in messages(tap.heard[-60:], "LOCAL_POSITION_NED")]
    return math.hypot(found[-1].vx, found[-1].vy, found[-1].vz) if found else 0.0


def mode(tap, since: float = 0.0) -> tuple[int, int]:
    modes = [px4_mode(message) for t, message in messages(tap.heard[-400:], "HEARTBEAT") if t >= since]
    return modes[-1] if modes else (0, 0)


def flies(tap) -> bool:
    """The vehicle says that it is off the ground."""
    states = [message.landed_state for _, message in messages(tap.heard[-800:], "EXTENDED_SYS_STATE")]
    return bool(states) and states[-1] != mavlink.MAV_LANDED_STATE_ON_GROUND


def hears(view) -> bool:
    """The program hears the vehicle now, and did not only before a fault."""
    return bool(view.status and view.status.connected and view.t - view.status.t < 0.3)


def holds(tap) -> bool:
    return mode(tap) == (PX4_AUTO, PX4_LOITER) and speed(tap) < 0.2


def is_safe(tap) -> bool:
    """The vehicle holds, or returns, which is what PX4 does by itself when setpoints end and there are no sticks."""
    return holds(tap) or mode(tap) == (PX4_AUTO, PX4_RETURN)


def asked(payload: bytes) -> tuple[float, ...]:
    """Return what a setpoint asks for: velocity (FRD, m/s) and yaw rate (rad/s)."""
    numbers = struct.unpack("<11fHBBB", payload)
    return (*numbers[3:6], numbers[10])


def another_station() -> mavlink.MAVLink:
    return mavlink.MAVLink(None, srcSystem=254, srcComponent=190)


def set_parameters(tap, **values: float) -> None:
    """Set the simulated vehicle's own parameters, from its side of the wire."""
    other = another_station()
    for name, value in values.items():
        kind = mavlink.MAV_PARAM_TYPE_INT32 if isinstance(value, int) else mavlink.MAV_PARAM_TYPE_REAL32
        # PX4 has the bytes of a whole number where MAVLink has a float.
        sent = struct.unpack("<f", struct.pack("<i", value))[0] if isinstance(value, int) else value
        tap.inject(bytes(other.param_set_encode(1, 1, name.encode(), sent, kind).pack(other)))


class Stage:
    """A flight that faults are done to, one after the other: what one of them spoils is started anew.

    Args:
        folder: Where hand, mission and recordings are.
        options: More of the program's own.
        device: What the hand holds, as for `--device`, with its socket to follow.
        push: How far the hand leads the vehicle, m.
        vehicle_options: More of the vehicle's own.
        environment: Of the program and its processes.

    Attributes:
        url: What the program connects to: the tap, where nothing is between them.
        tap: The wire between program and vehicle.
        program: The program as it runs now.
        hand: The hand as it holds now.
    """

    def __init__(
        self,
        folder: Path,
        *options: str,
        device: str = "virtual:",
        push: float = 0.06,
        vehicle_options: tuple[str, ...] = (),
        environment: dict[str, str] | None = None,
    ) -> None:
        self._options, self._device, self._push, self._environment = options, device, push, environment
        self._vehicle_options = vehicle_options
        self.hand_socket = str(folder / "hand.sock")
        self.mission = folder / "long.toml"
        self.mission.write_text(LONG)
        self.logs = folder / "logs"
        self.tap = Tap()
        self.url = f"udpout://127.0.0.1:{self.tap.program_port}"
        self._vehicle = contextlib.ExitStack()
        self.program: Program | None = None
        self.hand: Hand | None = None
        self.start_vehicle()

    def start_vehicle(self) -> None:
        """Start the vehicle, standing on the ground; one that flies is switched off."""
        self._vehicle.close()
        self.mend()
        options = ("--mission", str(self.mission), *self._vehicle_options)
        self._vehicle.enter_context(vehicle(self.tap.vehicle_port, *options))

    def start_program(self) -> Program:
        """Start the program and the hand; those that run are ended."""
        self.end_program()
        self.hand = Hand(self.hand_socket)
        self.program = Program(
            "--connect", self.url, "--device", self._device + self.hand_socket,
            "--mission", str(self.mission), "--logs", str(self.logs), *self._options,
            columns=80, rows=24, environment=self._environment,
        )  # fmt: skip
        return self.program

    def end_program(self) -> None:
        if self.hand:
            self.hand.close()
        if self.program:
            self.program.close()
        self.hand = self.program = None

    def close(self) -> None:
        self.end_program()
        self._vehicle.close()
        self.tap.close()

    def cut(self) -> float:
        """Let nothing pass between program and vehicle, and return since when."""
        self.tap.passes = lambda _: False
        return time.monotonic()

    def mend(self) -> float:
        """Let everything pass again, and return since when."""
        self.tap.passes = lambda _: True
        return time.monotonic()

    @property
    def ready(self) -> Program:
        """The program with all its processes, started where one is missing."""
        program = self.program
        if program is None or program.process.poll() is not None or not set(program.pids()) >= OURS:
            program = self.start_program()
        return program

    def coupled(self) -> "Stage":
        """Have the vehicle in the air and led by the hand, whatever was before."""
        program = self.ready
        self.mend()
        self.hand.put((0.0, 0.0, 0.0))
        self.see(
            lambda view: hears(view) and view.status.in_air == flies(self.tap) and not view.status.unsafe,
            40,
            "heard",
        )
        self.see(lambda view: view.device and view.device.homed, 20, "the device is homed")
        if program.console.snapshot().status.in_air:
            # Whatever it was doing by itself, such as landing, as far as it has not got there.
            since = time.monotonic()
            self.act(
                CommandKind.HOLD,
                lambda view: not view.status.in_air or mode(self.tap, since) == (PX4_AUTO, PX4_LOITER),
                "holding",
            )
        if not program.console.snapshot().status.in_air:
            self.see(
                lambda view: view.status.health & Health.ARMABLE and not view.status.armed, 40, "armable"
            )
            self.act(CommandKind.ARM, lambda view: view.status.armed, "armed")
            self.act(CommandKind.TAKEOFF, lambda view: view.status.in_air, "in the air")
            self.see(hovers, 30, "hovering")
        self.engage()
        # There and back, so that a long series of faults stays where it began.
        self._push = -self._push
        self.hand.put((self._push, 0.0, 0.0))
        until(lambda: speed(self.tap) > 0.5, 10, "the vehicle follows the hand")
        self.tap.setpoints.clear()
        until(lambda: len(self.tap.setpoints) > 3, 2, "setpoints leave")
        return self

    def see(self, condition, within_s: float, what: str):
        """Wait for a snapshot as `Program.until` does; a test fails where a bench ends."""
        try:
            return self.program.until(condition, within_s, what)
        except SystemExit as error:
            pytest.fail(str(error))

    def engage(self) -> None:
        self.act(CommandKind.ENGAGE, lambda view: view.pilot and view.pilot.phase == Phase.ENGAGED, "engaged")

    def act(self, kind: CommandKind, condition, what: str) -> None:
        """Give a command until it has done what it does: right after a fault it may be refused."""
        for _ in range(8):
            self.program.console.command(kind)
            with contextlib.suppress(SystemExit):
                self.program.until(condition, 4, what)
                return
        self.see(condition, 4, what)

    def uncoupled(self, within_s: float = 5.0):
        return self.see(lambda view: view.pilot.phase == Phase.DISENGAGED, within_s, "uncoupled")

    def stays_uncoupled(self, seconds: float) -> None:
        """Look for a while: nobody engages, and not one setpoint leaves."""
        self.tap.setpoints.clear()
        # Who wakes has not said yet what became of it.
        self.uncoupled(2.0)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            assert self.program.console.snapshot().pilot.phase == Phase.DISENGAGED
            time.sleep(0.02)
        assert self.tap.setpoints == []

    def told(self, words: str, since: float, within_s: float = 5.0) -> float:
        """Wait until the program has told something, and return when it did, monotonic s."""
        return until(lambda: self._told(words, since), within_s, f"it is told: {words}")

    def _told(self, words: str, since: float) -> float:
        events = self.program.console.snapshot().events
        return next((e.t for e in events if e.t >= since and words in e.text.decode(errors="replace")), 0.0)

    def signal(self, number: int, *roles: str) -> float:
        """Send a signal to processes of the program and return when."""
        pids = self.program.pids() | {"screen": self.program.process.pid}
        for role in roles:
            os.kill(pids[role], number)
        return time.monotonic()
