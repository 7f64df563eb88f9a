"""A terminal that goes is noticed; one that stays is left alone."""

import os
import pty
import threading

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


def test_a_terminal_with_input_waiting_has_not_gone():
    controller, terminal = pty.openpty()
    gone = threading.Event()
    watch = HangupWatch(terminal, gone.set)
    os.write(controller, b"keys\n")
    assert not gone.wait(0.5)
    watch.stop()
    os.close(controller)
    os.close(terminal)
