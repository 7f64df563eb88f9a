"""Steps per second of processor time, one contest after another, on request: what peers and our own run on."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from typing import NamedTuple

# One look lasts so long, s.
LOOK_S = 0.15


class Contest(NamedTuple):
    """Something to be measured.

    Attributes:
        name: As in the table.
        steps: Vehicle steps in a call.
        call: What takes them.
    """

    name: str
    steps: int
    call: Callable[[], object]


class Meter:
    """Measures a contest again and again."""

    def __init__(self, contest: Contest) -> None:
        self.contest = contest
        self._calls = 1
        while self._seconds() < LOOK_S / 4:
            self._calls *= 2
        self._calls = max(1, round(self._calls * LOOK_S / self._seconds()))

    def look(self) -> float:
        """Return vehicle steps per second of processor time."""
        return self._calls * self.contest.steps / self._seconds()

    def _seconds(self) -> float:
        call = self.contest.call
        begin = time.process_time()
        for _ in range(self._calls):
            call()
        return time.process_time() - begin


def serve(contests: list[Contest]) -> None:
    """Tell the contests' names, then for every line read, a look at each: JSON, a line each."""
    meters = [Meter(contest) for contest in contests]
    print(json.dumps([contest.name for contest in contests]), flush=True)
    for _line in sys.stdin:
        print(json.dumps({meter.contest.name: meter.look() for meter in meters}), flush=True)
