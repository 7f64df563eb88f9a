"""How late a loop's ticks were, lately and since the start: kept without allocating, sorted only when asked."""

from __future__ import annotations

from typing import NamedTuple

# Of the tally's bins, s; beyond the last one everything counts as just over it.
_BIN_S = 5e-6
_BINS = 4000


class Figures(NamedTuple):
    """Median, 99th percentile and largest of the latest ticks, median and 99th percentile of all; s."""

    p50: float = 0.0
    p99: float = 0.0
    largest: float = 0.0
    run_p50: float = 0.0
    run_p99: float = 0.0


class Lateness:
    """The latenesses since the last report, each as it was, and all since the start, in bins of 5 µs.

    Args:
        size: Ticks it holds between reports; of more, the latest.
    """

    def __init__(self, size: int) -> None:
        self._values = [0.0] * size
        self._size = size
        self._count = 0
        self._bins = [0] * (_BINS + 1)
        self._total = 0

    def add(self, late: float) -> None:
        """Take note of a tick's lateness, s."""
        self._values[self._count % self._size] = late
        self._count += 1
        self._bins[min(int(late / _BIN_S), _BINS)] += 1
        self._total += 1

    def report(self) -> Figures:
        """Return the figures, and begin to collect for the next report; zeros where there was no tick."""
        count = min(self._count, self._size)
        self._count = 0
        if not count:
            return Figures()
        ordered = sorted(self._values[:count])
        p50, p99 = ordered[(count - 1) // 2], ordered[(99 * (count - 1) + 99) // 100]
        return Figures(p50, p99, ordered[-1], self._below(0.5), self._below(0.99))

    def _below(self, share: float) -> float:
        """Return the lateness that this share of all ticks does not exceed, s, to a bin."""
        wanted = share * self._total
        seen = 0
        for number, count in enumerate(self._bins):
            seen += count
            if seen >= wanted:
                return number * _BIN_S
        return _BINS * _BIN_S
