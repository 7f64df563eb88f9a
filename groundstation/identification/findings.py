"""All that an identification came to: what is printed, drawn and written is made of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from groundstation.identification.fit import Identified
from groundstation.identification.matrix import Matrix
from groundstation.identification.samples import Samples
from groundstation.identification.validate import Validation
from sim.models.dynamic import Chi


class Findings(NamedTuple):
    """What was found, and how well it tells the flights.

    Attributes:
        identified: χ and what goes with it.
        learned: The flights it is from.
        flights: Those and the ones it has not seen.
        validations: One a flight of `flights`.
        matrix: Each learned from alone and all told, where there are several.
        compared: Name of an airframe to compare with, or None.
        compared_chi: Its χ.
        compared_validations: How well that tells the flights, without a delay.
    """

    identified: Identified
    learned: Sequence[Samples]
    flights: Sequence[Samples]
    validations: Sequence[Validation]
    matrix: Matrix | None
    compared: str | None
    compared_chi: Chi | None
    compared_validations: Sequence[Validation] | None

    def seen(self, place: int) -> bool:
        """Whether it learned from the flight at a place in `flights`."""
        return place < len(self.learned)
