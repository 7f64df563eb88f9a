"""What all tests share."""

import os
import signal

from hypothesis import settings

# Examples run on machines shared with other work: how long one takes says nothing.
settings.register_profile("groundstation", deadline=None)
settings.load_profile("groundstation")

# Some tests open a terminal of their own, which can redraw whatever the tests themselves were started from.
if os.environ.get("TERM") == "dumb":
    os.environ["TERM"] = "xterm-256color"


def pytest_configure():
    # A shell has what it starts in the background ignore Ctrl-C, and so would all that the tests start.
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
