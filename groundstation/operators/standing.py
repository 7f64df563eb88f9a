"""How the simulated operators stand in a mission: what each flight scores against the expert's, and who passes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from groundstation.operators.exercise import NOBODY, Flown
from groundstation.training.mission import Mission
from groundstation.training.par import par_in
from groundstation.training.reference import EXPERT, Reference, digest_of
from groundstation.training.score import score_of
from sim.people import PEOPLE


class Marked(NamedTuple):
    """A flight, its points, and what keeps it from being passed, in words."""

    flown: Flown
    points: float
    lacks: tuple[str, ...]


class Standing(NamedTuple):
    """A mission as it was flown.

    Attributes:
        mission: Which.
        reference: What the people reached.
        marked: Every flight.
        fault: Why it makes no par, or "".
    """

    mission: Mission
    reference: Reference
    marked: tuple[Marked, ...]
    fault: str

    def of(self, operator: str) -> list[Marked]:
        """Return the flights of one operator."""
        return [each for each in self.marked if each.flown.operator == operator]


def standing_of(mission: Mission, flown: Sequence[Flown]) -> Standing:
    """Return how the operators stand in a mission, each flight held against the expert's on the same seed."""
    reference = reference_of(mission, flown)
    marked = tuple(_marked(mission, reference, each) for each in flown)
    return Standing(mission, reference, marked, _fault(marked))


def reference_of(mission: Mission, flown: Sequence[Flown]) -> Reference:
    """Return what the people reached, for those who will fly the mission after them."""
    people = {name: sorted((each for each in flown if each.operator == name), key=_seed) for name in PEOPLE}
    return Reference(
        digest_of(mission),
        {name: {each.seed: each.measures for each in them} for name, them in people.items()},
        {name: each.track for name, them in people.items() for each in them if each.seed == 0},
    )


def _seed(flown: Flown) -> int:
    return flown.seed


def _marked(mission: Mission, reference: Reference, flown: Flown) -> Marked:
    par, _ = par_in(reference, flown.seed)
    score = score_of(mission, flown.measures, par)
    points = score.points if score else 0.0
    least = mission.criteria.min_points
    low = (f"{points:.0f} points are under {least:g}",) if points < least else ()
    return Marked(flown, points, (*flown.shortcomings, *low))


def _fault(marked: Sequence[Marked]) -> str:
    """Return why the flights make no par, or ""."""
    failed = next((each for each in marked if each.flown.operator == EXPERT and each.lacks), None)
    if failed:
        return f"the expert fails on seed {failed.flown.seed}: {'; '.join(failed.lacks)}"
    if any(each.flown.operator == NOBODY and not each.lacks for each in marked):
        return "a hand that does nothing passes; ask for something"
    return ""
