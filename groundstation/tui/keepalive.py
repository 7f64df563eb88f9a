"""Keeps the on-screen stick alive: sends its deflection at a steady rate, for as long as the screen is alive.

A screen that paints may be late by more than the 0.1 s after which a handle counts as stale, so a thread of its
own sends. It falls silent when the screen's loop has not turned for a while: then the stick's last deflection is
nobody's wish any more, and silence uncouples the hand.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

# The stick is stale after 0.1 s; at this rate one that is late still comes in time.
RATE_HZ = 50.0
# Longer than any frame takes, short enough that a drone flies on for less than half a second.
SCREEN_STALL_S = 0.3


class Keepalive:
    """Calls `send` at a steady rate while the screen turns.

    Args:
        send: Sends the deflection as it is now.
        clock: Monotonic seconds.
    """

    def __init__(self, send: Callable[[], None], clock: Callable[[], float] = time.monotonic) -> None:
        self._send = send
        self._clock = clock
        self._turned_t = clock()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="stick", daemon=True)

    def start(self) -> None:
        """Begin to send."""
        self._thread.start()

    def turned(self) -> None:
        """The screen's loop has turned: what it sends is what the operator wants."""
        self._turned_t = self._clock()

    def stop(self) -> None:
        """Fall silent for good."""
        self._over.set()
        if self._thread.is_alive():
            self._thread.join()

    def due(self) -> bool:
        """Say whether the stick may be sent now."""
        return self._clock() - self._turned_t <= SCREEN_STALL_S

    def _run(self) -> None:
        while not self._over.wait(1.0 / RATE_HZ):
            if self.due():
                self._send()
