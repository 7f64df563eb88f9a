"""How hard a flight was for who flew it: the raw NASA Task Load Index.

S. G. Hart, L. E. Staveland: Development of NASA-TLX, in: Human Mental Workload, 1988. Six scales from 0 to 100 in
steps of 5; without the weighting of the original, their mean (S. G. Hart: NASA-Task Load Index; 20 years later,
2006).
"""

from __future__ import annotations

from typing import NamedTuple

from msgspec import Struct

STEP = 5
HIGHEST = 100
MIDDLE = 50


class Scale(NamedTuple):
    """One of the six: its name, what is asked, and what its ends mean."""

    name: str
    asks: str
    low: str
    high: str


SCALES = (
    Scale("mental", "How mentally demanding was the task?", "very low", "very high"),
    Scale("physical", "How physically demanding was the task?", "very low", "very high"),
    Scale("temporal", "How hurried or rushed was the pace of the task?", "very low", "very high"),
    # Its high end is failure: on every scale more is more load.
    Scale("performance", "How successful were you in doing what you were asked to do?", "perfect", "failure"),
    Scale("effort", "How hard did you have to work for your level of performance?", "very low", "very high"),
    Scale(
        "frustration", "How insecure, discouraged, irritated or annoyed were you?", "very low", "very high"
    ),
)


class Workload(Struct, frozen=True):
    """What was answered, 0 to 100 each."""

    mental: int = MIDDLE
    physical: int = MIDDLE
    temporal: int = MIDDLE
    performance: int = MIDDLE
    effort: int = MIDDLE
    frustration: int = MIDDLE

    @property
    def raw(self) -> float:
        """The raw index: the mean of the six, 0 to 100."""
        return sum(getattr(self, scale.name) for scale in SCALES) / len(SCALES)

    @property
    def words(self) -> str:
        """All of it in a line."""
        answers = ", ".join(f"{scale.name} {getattr(self, scale.name)}" for scale in SCALES)
        return f"Workload (raw NASA-TLX) {self.raw:.0f} of 100: {answers}."


def moved(value: int, steps: int) -> int:
    """Return an answer some steps further on, within the scale."""
    return min(max(value + STEP * steps, 0), HIGHEST)
