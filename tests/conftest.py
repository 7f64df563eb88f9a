"""What all tests share."""

import os
import signal
from collections import Counter

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


def pytest_collection_modifyitems(items):
    # Files that may take longest come first: several workers then end at about the same time.
    may_take = Counter()
    for item in items:
        if limit := item.get_closest_marker("timeout"):
            may_take[item.path] += limit.args[0]
    items.sort(key=lambda item: -may_take[item.path])
