"""Each flight learned from alone, and all told: whether a vehicle is one and the same from flight to flight."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from groundstation.errors import InputError
from groundstation.identification.fit import Tell, identify
from groundstation.identification.samples import Numbers, Samples
from groundstation.identification.validate import validated


class Pair(NamedTuple):
    """A flight told by what was learned from one.

    Attributes:
        learned: Name of the one.
        flight: Name of the other, or the same.
        free: (4,), R² of the free flight by axis.
    """

    learned: str
    flight: str
    free: Numbers


class Matrix(NamedTuple):
    """All pairs, in the order of the flights.

    Attributes:
        pairs: Row by row.
        alone: Why a flight tells too little alone, a sentence each.
    """

    pairs: Sequence[Pair]
    alone: Sequence[str]


def each_on_each(flights: Sequence[Samples], longest_delay: float, tell: Tell) -> Matrix:
    """Learn from each flight alone, and tell all of them.

    Args:
        flights: With the same step.
        longest_delay: That is looked for, s.
        tell: Told what is being done.
    """
    pairs: list[Pair] = []
    alone: list[str] = []
    for number, learned in enumerate(flights, 1):
        tell(f"learning from flight {number} of {len(flights)} alone")
        try:
            found = identify([learned], longest_delay=longest_delay).parameters
        except InputError as error:
            alone.append(str(error))
            continue
        for flight in flights:
            free = validated(found.chi, found.delays, flight).free
            pairs.append(Pair(learned.name, flight.name, free))
    return Matrix(pairs, alone)
