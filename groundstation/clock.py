"""Time for loops: a pace of absolute deadlines, and what is due every so often. Clock and sleep are given."""

from __future__ import annotations

import time
from collections.abc import Callable

Clock = Callable[[], float]


class Pacer:
    """Keeps a loop on a grid of absolute deadlines, so that lateness never adds up.

    A deadline that is more than one period past is given up and counted as missed: a loop that was held up
    does not hurry through what it missed.

    Args:
        period: From one deadline to the next, s.
        clock: Monotonic seconds.
        sleep: Waits a number of seconds.
        spin: The last stretch before a deadline that is waited for without sleeping, s.

    Attributes:
        missed: Deadlines given up since the start.
        elapsed: From the last deadline met to this one, s: a whole number of periods.
    """

    def __init__(
        self,
        period: float,
        clock: Clock = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
        spin: float = 0.0,
    ) -> None:
        self._period = period
        self._clock = clock
        self._sleep = sleep
        self._spin = spin
        self._deadline = clock()
        self.missed = 0
        self.elapsed = period

    def restart(self, period: float) -> None:
        """Begin a new grid now, as when the loop is to run at another rate."""
        self._period = self.elapsed = period
        self._deadline = self._clock()

    def wait(self) -> float:
        """Wait for the next deadline and return how late it was met, s."""
        clock = self._clock
        deadline = self._deadline + self._period
        self.elapsed = self._period
        behind = clock() - deadline
        if behind > self._period:
            skipped = int(behind / self._period)
            deadline += skipped * self._period
            self.missed += skipped
            self.elapsed += skipped * self._period
        self._deadline = deadline
        while (left := deadline - clock() - self._spin) > 0.0:
            self._sleep(left)
        while (late := clock() - deadline) < 0.0:
            pass
        return late


class Every:
    """Says when something that is done every so often is due, on a grid of its own.

    Args:
        period: s.
    """

    def __init__(self, period: float) -> None:
        self._period = period
        self._next = -float("inf")

    def due(self, now: float) -> bool:
        """Say whether it is time, once a period; what was missed is not made up for."""
        if now < self._next:
            return False
        held_up = now - self._next > self._period
        self._next = (now if held_up else self._next) + self._period
        return True
