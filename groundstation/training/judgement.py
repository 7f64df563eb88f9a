"""A finished flight judged: its measures, its score, what it lacks, and where it lost its points."""

from __future__ import annotations

from typing import NamedTuple

from groundstation.training.measurer import Measurer
from groundstation.training.measures import Measures
from groundstation.training.score import Score, score_of, shortcomings
from groundstation.training.story import Moment, story_of


class Judgement(NamedTuple):
    """What a flight came to.

    Attributes:
        measures: In numbers.
        score: None where the mission leads nowhere.
        shortcomings: In words, all that keeps it from being passed.
        story: Where points were lost, what cost most first.
        took_off_t: When it took off, s on the clock of the flight.
    """

    measures: Measures
    score: Score | None
    shortcomings: tuple[str, ...]
    story: tuple[Moment, ...]
    took_off_t: float

    @property
    def passed(self) -> bool:
        """All that the mission asks for was done."""
        return self.score is not None and not self.shortcomings


def judgement_of(measurer: Measurer, par: Measures | None) -> Judgement:
    """Return what a flight came to.

    Args:
        measurer: Has seen the flight.
        par: What it is held against; None where nobody has flown it for reference.
    """
    measures = measurer.measures()
    score = score_of(measurer.director.mission, measures, par)
    story = story_of(measurer, score) if score else ()
    return Judgement(measures, score, shortcomings(measurer.director, score), story, measurer.took_off_t)
