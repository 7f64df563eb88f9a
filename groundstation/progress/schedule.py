"""When a mission is to be flown again: Leitner's boxes.

A mission that was passed well moves into the next box, whose wait is longer; one that was failed goes back to the
first and is due at once. A day counts once: flying a mission ten times in an evening moves it by one box.

Leitner, "So lernt man lernen", 1972. That what is repeated after a while is kept longer than what is repeated at
once: Cepeda et al., "Distributed practice in verbal recall tasks", 2006.
"""

from __future__ import annotations

import datetime
from collections.abc import Iterable
from typing import NamedTuple

from groundstation.progress.flown import Flown

# Days until a mission in each box is due again.
WAITS = (1, 3, 7, 14, 30)
# Passed with less than this it stays in its box.
WELL = 70.0


class Repetition(NamedTuple):
    """When a mission is due.

    Attributes:
        box: Of 0 to `len(WAITS) - 1`.
        due: The day.
    """

    box: int
    due: datetime.date


def repetition_of(flights: Iterable[Flown]) -> Repetition | None:
    """Return when a mission is due again; None where it was never passed.

    Args:
        flights: One pilot's of one mission, oldest first.
    """
    known: Repetition | None = None
    moved: datetime.date | None = None
    for each in flights:
        day = each.day
        if not each.passed:
            if known:
                known = Repetition(0, day)
            continue
        box = known.box if known else 0
        if known and day != moved and (each.points or 0.0) >= WELL:
            box = min(box + 1, len(WAITS) - 1)
        moved = day
        known = Repetition(box, day + datetime.timedelta(days=WAITS[box]))
    return known
