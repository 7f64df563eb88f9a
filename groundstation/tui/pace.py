"""How often to paint: as often as the terminal takes it. Pure.

A terminal that is slow, over a radio or a long SSH line, lets its writer wait; then the screen's own turns come late,
and that is what is measured. Fewer frames are painted until turns come in time again; nothing else slows down.
"""

from __future__ import annotations

import math

SLOWEST_HZ = 10.0
# Of the turns in a second so many may be late, and later than so many of their periods is late.
_LATE_SHARE, _LATE_PERIODS = 0.25, 1.6
_WINDOW_S = 1.0
# One bad second is a hiccup of the machine; so many one after the other are a slow terminal.
_BAD_WINDOWS = 2
# After so long without trouble a quicker pace is tried; twice as long after each try that failed, s.
_TRY_S, _TRY_LONGEST_S = 2.0, 64.0
# If trouble comes so soon after it, the try has failed, s.
_STEP_UP_FAILED_S = 4.0
# After so long at the whole rate earlier tries that failed are forgotten, s.
_GOOD_S = 10.0


class PaintPace:
    """Says at which turns to paint.

    Args:
        fastest_hz: How often the screen turns, and paints where the terminal keeps up.
    """

    def __init__(self, fastest_hz: float) -> None:
        self._period = 1.0 / fastest_hz
        self._fastest = fastest_hz
        self._slowest = max(int(fastest_hz // SLOWEST_HZ), 1)
        self._every = 1
        self._turn = 0
        self._last = math.nan
        self._window_end = -math.inf
        self._turns = self._late = self._bad = 0
        self._calm_since = self._tried = -math.inf
        self._wait = _TRY_S

    @property
    def rate(self) -> float:
        """Frames painted a second where turns come in time, Hz."""
        return self._fastest / self._every

    def due(self, now: float) -> bool:
        """Take note of a turn at a monotonic time, s, and say whether to paint in it."""
        gap = now - self._last
        self._last = now
        if math.isfinite(gap):
            self._turns += 1
            self._late += gap > _LATE_PERIODS * self._period
        if now >= self._window_end:
            self._judge(now)
            self._turns = self._late = 0
            self._window_end = now + _WINDOW_S
        self._turn += 1
        return self._turn % self._every == 0

    def _judge(self, now: float) -> None:
        bad = self._turns > 0 and self._late > _LATE_SHARE * self._turns
        self._bad = self._bad + 1 if bad else 0
        if self._bad >= _BAD_WINDOWS:
            self._bad = 0
            if self._every < self._slowest:
                self._every += 1
            if now - self._tried < _STEP_UP_FAILED_S:
                self._wait = min(2.0 * self._wait, _TRY_LONGEST_S)
            self._calm_since, self._tried = now, -math.inf
        elif bad:
            self._calm_since = now
        elif self._every > 1 and now - self._calm_since >= self._wait:
            self._every -= 1
            self._calm_since = self._tried = now
        elif self._every == 1 and now - self._calm_since >= _GOOD_S:
            self._wait = _TRY_S
