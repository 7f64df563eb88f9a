"""A terminal that goes is noticed; one that stays is left alone."""

import os
import pty
import signal
import sys
import threading

import pytest

from groundstation.tui.hangup import HangupWatch


def test_a_terminal_that_goes_is_noticed():
    controller, terminal = pty.openpty()
    gone = threading.Event()
    watch = HangupWatch(terminal, gone.set)
    assert not gone.wait(0.5)
    os.close(controller)
    assert gone.wait(20)
    watch.stop()
    os.close(terminal)


@pytest.mark.parametrize("words", [[], ["school"]], ids=["connect", "school"])
def test_a_screen_before_the_flight_ends_with_its_terminal(words, tmp_path):
    pid, controller = pty.fork()
    if not pid:
        # Under make, or where a shell has it so, nobody tells the program.
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        os.execv(sys.executable, [sys.executable, "-m", "groundstation.cli", *words, "--logs", str(tmp_path)])
    while b"\x1b[?1049h" not in os.read(controller, 4096):
        pass
    os.close(controller)
    _, status = os.waitpid(pid, 0)
    assert os.waitstatus_to_exitcode(status) == 128 + signal.SIGHUP


def test_a_terminal_with_input_waiting_has_not_gone():
    controller, terminal = pty.openpty()
    gone = threading.Event()
    watch = HangupWatch(terminal, gone.set)
    os.write(controller, b"keys\n")
    assert not gone.wait(0.5)
    watch.stop()
    os.close(controller)
    os.close(terminal)
