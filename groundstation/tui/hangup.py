"""Ends the screen when its terminal has gone: a window closed, an SSH connection lost.

Textual's writer dies with the terminal and everything that waits for it waits for ever, so nothing in the
application can be asked to end. The others are made for that: they see their supervisor gone, leave the hand
without force and the vehicle holding, close their logs, and the last one sweeps the run.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Generator

_POLL_MS = 200


class HangupWatch:
    """Watches a terminal from a thread of its own.

    Args:
        descriptor: Of the terminal.
        gone: Called once when it has hung up.
    """

    def __init__(self, descriptor: int, gone: Callable[[], None] | None = None) -> None:
        self._poll = select.poll()
        # Hang-ups and errors are reported without being asked for.
        self._poll.register(descriptor, 0)
        self._gone = gone or _end_at_once
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="hangup", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Watch no longer."""
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._over.is_set():
            if self._poll.poll(_POLL_MS):
                self._gone()
                return


@contextlib.contextmanager
def watched() -> Generator[None]:
    """End the program at once should its terminal go while the block runs."""
    watch = HangupWatch(sys.stdin.fileno())
    try:
        yield
    finally:
        watch.stop()


def _end_at_once() -> None:
    os._exit(128 + signal.SIGHUP)
