"""Keeping time: virtual steps at the pace of a real clock."""

from __future__ import annotations

from collections.abc import Callable

# After a pause longer than this (a stopped process, a sleeping laptop) the lost time stays lost.
CATCH_UP_S = 0.1


class Pacer:
    """Waits for absolute deadlines, so that lateness does not add up.

    Args:
        period: Between deadlines, s.
        clock: Monotonic seconds.
        sleep: Waits so many seconds.
    """

    def __init__(self, period: float, clock: Callable[[], float], sleep: Callable[[float], None]) -> None:
        self._period = period
        self._clock = clock
        self._sleep = sleep
        self._next = clock() + period

    def wait(self) -> None:
        """Return at the next deadline; at once where it has passed."""
        left = self._next - self._clock()
        if left > 0.0:
            self._sleep(left)
        elif left < -CATCH_UP_S:
            self._next = self._clock() - CATCH_UP_S
        self._next += self._period
