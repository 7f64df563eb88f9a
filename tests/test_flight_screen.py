"""The real screen in a pseudo-terminal, by its keys alone: connect, preflight, fly, debrief, quit."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import termios
import time
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import common as mavlink

from bench.rig import Hand, Program, Tap, hovers, vehicle
from groundstation.messages import COMMAND, CommandKind, FlightMode, Phase
from groundstation.vehicle.px4 import JUDGED

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]

F2, F3, F7, F8, F9, UP = "\x1bOQ", "\x1bOR", "\x1b[18~", "\x1b[19~", "\x1b[20~", "\x1b[A"
_CONTROL = re.compile(rb"\x1b\[[0-9;?]*[a-zA-Z]|\x1b[()][A-Z0-9]")


def shows(program: Program, words: str, within_s: float = 15.0) -> None:
    """Wait until the terminal has been given these words since the last time."""
    end = time.monotonic() + within_s
    while time.monotonic() < end:
        text = _CONTROL.sub(b"", bytes(program.screen)).decode(errors="replace")
        if words in text:
            program.screen.clear()
            return
        time.sleep(0.02)
    pytest.fail(f"{words!r} was not shown; last: {text[-1500:]}")


def press(program: Program, key: str, condition, what: str) -> None:
    """Press a key until it has done what it does: the screen may not have seen yet what the bus knows."""
    for _ in range(8):
        program.type(key)
        with contextlib.suppress(SystemExit):
            program.until(condition, 4, what)
            return
    pytest.fail(f"{key!r} did not do it: {what}")


class Connecting(Program):
    """The program while it asks what to fly: there is no bus to join before that is answered."""

    def _join(self):
        shows(self, "what shall be flown?", 30.0)
        self.type("\r")
        return super()._join()


def test_from_preflight_through_a_flight_to_the_debrief_and_back_by_keys_alone(tmp_path):
    program = Program("--sim", "--mission", "hover", "--logs", str(tmp_path), columns=120, rows=40)
    commands = program.bus.subscriber(COMMAND)
    try:
        program.until(
            lambda view: view.status and view.status.health & 64 and len(view.parameters) >= len(JUDGED),
            40,
            "ready",
        )
        program.type(F7)
        shows(program, "COM_OF_LOSS_T = 1")
        program.type(F7)
        press(program, "A", lambda view: view.status.armed, "armed")
        press(program, "t", lambda view: view.status.in_air, "in the air")
        program.until(hovers, 30, "hovering")
        press(program, "e", lambda view: view.pilot.phase == Phase.ENGAGED, "engaged")
        program.type(UP * 2)
        program.until(
            lambda view: view.vehicle.velocity[0] ** 2 + view.vehicle.velocity[1] ** 2 > 0.04, 10, "led"
        )
        # From a page with text being typed, the key that holds; the vehicle is released and stands.
        program.type(F9)
        shows(program, "parameters of the vehicle")
        program.type("/h")
        list(commands.drain())
        program.type(F2)
        program.until(lambda view: view.status.mode == FlightMode.HOLD, 10, "holding")
        assert [each.kind for each in commands.drain() if each.source == b"screen"] == [CommandKind.HOLD]
        program.until(lambda view: view.pilot.phase == Phase.DISENGAGED, 5, "released")
        program.type(F9 + F3)
        program.until(lambda view: not view.status.armed, 40, "landed and disarmed")
        shows(program, "debrief")
        program.type(F8)
        program.type("q")
        assert program.process.wait(30) == 0
    finally:
        program.close()
    assert list(tmp_path.glob("*_hover.rrd"))


def test_without_a_vehicle_the_choice_comes_first_and_enter_flies(tmp_path):
    program = Connecting("--logs", str(tmp_path), columns=120, rows=40)
    try:
        program.until(
            lambda view: view.status and view.status.connected, 40, "the simulated vehicle is there"
        )
        program.type("q")
        assert program.process.wait(30) == 0
    finally:
        program.close()


def test_a_real_vehicle_is_typed_for_and_another_that_takes_over_is_told_and_not_fought(tmp_path):
    tap, hand = Tap(), Hand(str(tmp_path / "hand.sock"))
    with vehicle(tap.vehicle_port):
        program = Program(
            "--connect", f"udpout://127.0.0.1:{tap.program_port}", "--device", f"virtual:{tmp_path / 'hand.sock'}",
            "--mission", "hover", "--logs", str(tmp_path), columns=80, rows=24,
        )  # fmt: skip
        try:
            program.until(
                lambda view: view.status and view.status.health & 64 and not view.status.unsafe, 40, "ready"
            )
            shows(program, "■ REAL")
            press(program, "Ay", lambda view: view.status.armed, "armed")
            press(program, "ty", lambda view: view.status.in_air, "in the air")
            program.until(hovers, 30, "hovering")
            press(program, "e", lambda view: b"Engage the REAL" in program.screen, "asked")
            assert program.console.snapshot().pilot.phase == Phase.DISENGAGED
            program.type("REAL\r")
            program.until(lambda view: view.pilot.phase == Phase.ENGAGED, 20, "engaged")
            program.screen.clear()
            other = mavlink.MAVLink(None, srcSystem=254, srcComponent=190)
            hold = other.command_long_encode(1, 1, 176, 0, 1 | 128, 4, 3, 0, 0, 0, 0)
            tap.inject(bytes(hold.pack(other)))
            shows(program, "by another", 5.0)
            program.until(lambda view: view.pilot.phase == Phase.DISENGAGED, 1, "uncoupled")
            tap.setpoints.clear()
            time.sleep(1.5)
            assert tap.setpoints == []
            assert (tmp_path / "connections.json").exists()
        finally:
            program.close()
            hand.close()
            tap.close()


def test_a_screen_that_was_stopped_goes_on_with_the_same_threads_and_leaves_the_terminal_as_it_was(tmp_path):
    program = Program("--sim", "--mission", "hover", "--logs", str(tmp_path), columns=80, rows=24)
    screen = program.process.pid
    threads = lambda: len(list(Path(f"/proc/{screen}/task").iterdir()))  # noqa: E731
    flags = lambda: termios.tcgetattr(program._controller)[:4]  # noqa: E731
    cooked = termios.tcgetattr(os.openpty()[1])[:4]
    try:
        program.until(lambda view: view.status and view.status.connected, 40, "heard")
        shows(program, "SIM")
        before, raw = threads(), flags()
        for _ in range(3):
            program.screen.clear()
            program.process.send_signal(signal.SIGSTOP)
            time.sleep(0.2)
            program.process.send_signal(signal.SIGCONT)
            # The whole is painted anew, with what does not change.
            shows(program, "attitude stick force")
        assert threads() == before
        assert flags() == raw != cooked
        press(program, F7, lambda view: b"round trip, loss" in program.screen, "a key is heard")
        program.process.send_signal(signal.SIGTERM)
        program.process.wait(30)
        assert flags() == cooked
    finally:
        program.close()
