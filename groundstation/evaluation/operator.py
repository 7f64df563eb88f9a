"""What the operator of a virtual flight does beside moving the handle: coupling, and choosing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from groundstation.pilot.choices import Choices


class Operator(Protocol):
    """Asked as the flight goes on."""

    def couples(self) -> bool:
        """Say whether the hand is to be coupled now; asked with every setpoint."""
        ...

    def choices(self) -> Choices:
        """Return what is chosen now; asked every tick."""
        ...


@dataclass(frozen=True, slots=True)
class Steady:
    """An operator who stays coupled and changes nothing.

    Attributes:
        chosen: All the flight long.
    """

    chosen: Choices

    def couples(self) -> bool:
        """Always."""
        return True

    def choices(self) -> Choices:
        """Return what was chosen at the start."""
        return self.chosen
