"""Takes a viewer that has just been started to a moment of the flight."""

from __future__ import annotations

import time
from collections.abc import Callable

from groundstation.recording.live import listening
from groundstation.recording.schema import TIMELINE

# A long flight on a slow machine takes this long to be loaded, s.
_PATIENCE_S = 120.0
_POLL_S = 0.25


def go_to(port: int, seconds: float, running: Callable[[], bool] = lambda: True) -> bool:
    """Wait until a viewer has loaded its recording, and show a moment of it; return whether that was possible.

    Args:
        port: Where the viewer listens on loopback.
        seconds: Of the recording's timeline.
        running: The viewer has not been closed yet.
    """
    deadline = time.monotonic() + _PATIENCE_S
    while running() and time.monotonic() < deadline:
        if listening(port) and _shown(port, seconds):
            return True
        time.sleep(_POLL_S)
    return False


def _shown(port: int, seconds: float) -> bool:
    """Show the moment, where the recording is loaded."""
    from rerun.experimental import ViewerClient

    try:
        viewer = ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
        state = viewer.get_state()
        known = {line.name for recording in state.recordings for line in recording.timelines}
        if state.loading or TIMELINE not in known:
            return False
        viewer.set_time(TIMELINE, duration=seconds, play_state="paused")
    except (RuntimeError, ConnectionError, TimeoutError, ValueError):
        # It listens before it answers.
        return False
    return True
