"""Whether this computer slept: the monotonic clock stands still meanwhile, so that what is hours old looks fresh.

Linux counts the time asleep in CLOCK_BOOTTIME and leaves it out of CLOCK_MONOTONIC (clock_gettime(2)); their
difference grows by it and by nothing else.
"""

from __future__ import annotations

import time
from collections.abc import Callable

# The two clocks are read one after the other; what comes between is no sleep.
_LEAST_S = 0.05


def since_boot() -> float:
    """Return the time since the machine started, that asleep included, s; where that is unknown, without it."""
    number = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if number is None else time.clock_gettime(number)


class Sleep:
    """Tells how long the computer has slept since this was made.

    Args:
        awake: Seconds, without those asleep.
        all_: Seconds, with them.
    """

    def __init__(
        self, awake: Callable[[], float] = time.monotonic, all_: Callable[[], float] = since_boot
    ) -> None:
        self._awake, self._all = awake, all_
        # Held up between the two readings it comes out too small; thrice in a row it hardly is.
        self._offset = max(all_() - awake() for _ in range(3))
        self._told = 0.0

    def seconds(self) -> float:
        """Return how long it has slept so far, s."""
        slept = self._all() - self._awake() - self._offset
        return slept if slept - self._told > _LEAST_S else self._told

    def clock(self) -> float:
        """Return the time awake and asleep, s, which is the monotonic clock's until the first sleep."""
        return self._awake() + self.seconds()

    def news(self) -> float:
        """Return for how long it has slept since this was last asked, s."""
        slept = self.seconds()
        news, self._told = slept - self._told, slept
        return news
