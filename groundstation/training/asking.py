"""Asks on the bus for something to happen to the flight, and hears what became of it."""

from __future__ import annotations

import itertools
import time

from groundstation.bus import Bus
from groundstation.messages import INTERVENTION, INTERVENTION_ANSWER, Intervention, InterventionAnswer
from groundstation.training.happening import Happening, packed


class Asker:
    """One who asks.

    Args:
        bus: The flight's.
        source: Who, as in "instructor" or "mission".
    """

    def __init__(self, bus: Bus, source: str) -> None:
        self._source = source.encode()
        # Others ask too, from processes of their own: numbers that began at another moment are other numbers.
        self._numbers = itertools.count(time.monotonic_ns())
        self._asked: set[int] = set()
        self._interventions = bus.publisher(INTERVENTION)
        self._answers = bus.subscriber(INTERVENTION_ANSWER)

    def ask(self, happening: Happening) -> None:
        """Ask for something to happen now."""
        number = next(self._numbers)
        self._asked.add(number)
        wish = Intervention(t=time.monotonic(), number=number, source=self._source)
        wish.happening = packed(happening)
        self._interventions.send(wish)

    def answers(self) -> list[InterventionAnswer]:
        """Return what became of what was asked for here, each answer once."""
        found = [answer for answer in self._answers.drain() if answer.number in self._asked]
        self._asked -= {answer.number for answer in found}
        return found
