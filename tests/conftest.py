"""What all tests share."""

import os

from hypothesis import settings

# Examples run on machines shared with other work: how long one takes says nothing.
settings.register_profile("groundstation", deadline=None)
settings.load_profile("groundstation")

# Some tests open a terminal of their own, which can redraw whatever the tests themselves were started from.
if os.environ.get("TERM") == "dumb":
    os.environ["TERM"] = "xterm-256color"
