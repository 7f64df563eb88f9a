"""How long the round trip is, judged by questions and their answers: pure, time is given.

A delay that has risen must be known at once, for gains depend on it; one that has fallen may wait. One late answer
says little, two in a row do; and that no answer comes at all, when one should, says that the way has become long.
"""

from __future__ import annotations

import math

# Answers after this are forgotten, s: the vehicle is taken to be gone long before.
_FORGOTTEN_S = 10.0
# Share of the difference that an answer takes off.
_SMOOTHING = 0.1
# An answer so much above the estimate is late, not jitter: share, and s.
_LATE, _LATE_S = 1.2, 0.01
# For so long nothing but loss may keep answers away: at 10 Hz and 30 % lost each way, eight in a row are 1 in 200.
_LOSS_S = 0.8


class Trips:
    """Questions under way, and the round trip as it is known by their answers."""

    def __init__(self) -> None:
        self._under_way: dict[int, float] = {}
        self._estimate = math.nan
        self._before = 0.0
        # When the newest question was asked that has been answered, s.
        self._answered_t = 0.0

    def asked(self, stamp: int, now: float) -> None:
        """Take note of a question.

        Args:
            stamp: What its answer will carry.
            now: When it is asked, s.
        """
        while self._under_way and now - next(iter(self._under_way.values())) > _FORGOTTEN_S:
            del self._under_way[next(iter(self._under_way))]
        self._under_way[stamp] = now

    def answered(self, stamp: int, now: float) -> None:
        """Take note of an answer; one that was never asked for, or came already, is none.

        Args:
            stamp: Of the question.
            now: When the answer came, s.
        """
        asked_t = self._under_way.pop(stamp, math.inf)
        if not asked_t <= now:
            return
        self._answered_t = max(self._answered_t, asked_t)
        trip, before = now - asked_t, self._before
        self._before = trip
        if math.isnan(self._estimate):
            self._estimate = trip
            return
        late = self._estimate * _LATE + _LATE_S
        if trip > late and before > late:
            self._estimate = min(trip, before)
        elif trip <= late:
            self._estimate += _SMOOTHING * (trip - self._estimate)

    def seconds(self, now: float) -> float:
        """Return the round trip, s: as the answers have it, or longer where none comes; NaN before the first."""
        if math.isnan(self._estimate):
            return math.nan
        return max(self._estimate, now - self._answered_t - _LOSS_S)
