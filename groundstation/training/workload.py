"""How hard a flight felt: the six scales of the NASA Task Load Index, as the pilot gives them.

Hart and Staveland, "Development of NASA-TLX", 1988; without weights, as in Hart, "NASA-TLX; 20 years later", 2006.
"""

from __future__ import annotations

from msgspec import Struct

# From 0 to 100 in steps of this, as on the paper form.
STEP = 5


class Workload(Struct, frozen=True):
    """A filled form: each scale from 0 to 100, less is better in all; `performance` runs from perfect to failure."""

    mental: int = 50
    physical: int = 50
    temporal: int = 50
    performance: int = 50
    effort: int = 50
    frustration: int = 50

    @property
    def raw(self) -> float:
        """The raw index: the mean of the scales, 0 to 100."""
        scales = (
            self.mental,
            self.physical,
            self.temporal,
            self.performance,
            self.effort,
            self.frustration,
        )
        return sum(scales) / len(scales)
