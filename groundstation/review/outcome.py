"""What a recorded flight came to: measured from the recording as it was measured live."""

from __future__ import annotations

from typing import NamedTuple

from groundstation.pilot.surroundings import USUAL_RADIUS
from groundstation.review.flight import Flight
from groundstation.review.sights import instructed, sights
from groundstation.training.attempts import Attempts
from groundstation.training.director import Figures, Stage
from groundstation.training.judgement import Judgement, judgement_of
from groundstation.training.mission import Mission
from groundstation.training.score import Score
from sim.airframe import load_airframe
from sim.scenario import ScenarioError


class Outcome(NamedTuple):
    """How a flight ended. Of several in one run it is the last that landed.

    Attributes:
        completed: The mission's criteria hold; None where it leads nowhere, or none was flown.
        result: In words.
        figures: What it came to; None where no mission was flown.
        judgement: Likewise, with score and story; None before take-off, and where no mission was flown.
    """

    completed: bool | None
    result: str
    figures: Figures | None = None
    judgement: Judgement | None = None

    @property
    def score(self) -> Score | None:
        """None where there is nothing to be judged by."""
        return self.judgement.score if self.judgement else None

    @property
    def shortcomings(self) -> tuple[str, ...]:
        """Each criterion that does not hold, in words."""
        return self.judgement.shortcomings if self.judgement and self.completed is not None else ()


def outcome_of(flight: Flight) -> Outcome:
    """Return what a flight came to."""
    mission = flight.mission
    if mission is None:
        return Outcome(None, "no mission")
    measurer = attempts_of(flight, mission).judged
    director = measurer.director
    if director.stage is Stage.WAITING:
        return Outcome(None, "did not take off", director.figures)
    judgement = judgement_of(measurer, flight.par)
    if not mission.judged:
        words = "landed" if director.stage is Stage.DONE else "in the air at the end of the recording"
        return Outcome(None, words, director.figures, judgement)
    words = "; ".join(judgement.shortcomings) or "completed"
    return Outcome(judgement.passed, words, director.figures, judgement)


def attempts_of(flight: Flight, mission: Mission) -> Attempts:
    """Return what has seen all of a recording of a mission."""
    attempts = Attempts(mission, radius_of(mission))
    for t, happening in sorted(instructed(flight), key=lambda done: done[0]):
        attempts.instruct(t, happening)
    for sight in sights(flight):
        attempts.show(sight)
    return attempts


def radius_of(mission: Mission) -> float:
    """Return the hull's radius, m; the usual one where the airframe's file has gone since."""
    try:
        return load_airframe(mission.vehicle.airframe).radius
    except ScenarioError:
        return USUAL_RADIUS
