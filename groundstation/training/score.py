"""A mission's score: from 0 to 100, part by part, each with its formula in words. `docs/scoring.md` explains them.

What a flight reached is held against its par: what the reference operator reached on the same seed. A mission that
nobody has flown for reference is judged by what is usual.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from groundstation.training.director import Director
from groundstation.training.measures import Measures
from groundstation.training.mission import Mission
from sim.scenario import Gate

# Further from obstacles than this nothing is gained, m: nobody shall be rewarded for a detour.
ROOMY_M = 0.5
# Without a par, quicker than this share of the time limit nothing is gained: nobody shall race.
UNHURRIED = 0.5
# The unit of what is a share of the whole.
SHARE = "share"
# What the missing part of an unfinished mission costs, beside the parts.
UNFINISHED = "unfinished"
NO_PAR = "what is usual: nobody has flown this mission for reference"


class Yardstick(NamedTuple):
    """How one part of a score is judged: all of it up to `good`, none from `poor` on, straight in between.

    Attributes:
        part: Its name.
        measure: The field of `Measures` that it judges.
        unit: Of the measure.
        weight: How much it counts beside the others.
        usual: What is good where there is no par.
        times: Poor is this many times what is good, unless the mission itself has a limit.
        least: Poor is at least so much from good, in the unit: a par of nothing at all is no trap.
        flown: It counts for the share of the mission's points that were reached: who does not fly gains nothing.
        rises: More is better.
    """

    part: str
    measure: str
    unit: str
    weight: int
    usual: float
    times: float
    least: float
    flown: bool = True
    rises: bool = False


YARDSTICKS: tuple[Yardstick, ...] = (
    Yardstick("time", "time_s", "s", 2, math.nan, 3.0, 10.0),
    Yardstick("following", "rms_error_m", "m", 2, 0.3, 3.0, 0.3),
    Yardstick("path", "path_error_m", "m", 2, 0.3, 3.0, 0.3),
    Yardstick("precision", "final_error_m", "m", 2, 0.0, 3.0, 0.1, flown=False),
    Yardstick("landing", "landing_error_m", "m", 3, 0.0, 3.0, 0.2, flown=False),
    Yardstick("clearance", "least_clearance_m", "m", 3, ROOMY_M, 3.0, 0.1, rises=True),
    Yardstick("gates", "gates_missed", SHARE, 3, 0.0, 1.0, 1.0, flown=False),
    Yardstick("smoothness", "smoothness", "", 1, -4.0, 3.0, 2.0, rises=True),
    Yardstick("agreement", "disagreement_mps", "m/s", 1, 0.02, 3.0, 0.1),
    Yardstick("effort", "effort_n", "N", 1, 0.5, 3.0, 0.5),
)
WHERE_ASKED: dict[str, Callable[[Mission], bool]] = {
    "path": lambda mission: bool(mission.route),
    "precision": lambda mission: mission.target is not None,
    "landing": lambda mission: mission.landing is not None,
    "clearance": lambda mission: bool(mission.obstacle),
    "gates": lambda mission: any(isinstance(obstacle, Gate) for obstacle in mission.obstacle),
    "agreement": lambda mission: bool(mission.obstacle or mission.fence),
}


class Part(NamedTuple):
    """One part of a score.

    Attributes:
        name: Of what is judged.
        measure: The field of `Measures` that was judged.
        value: What the flight reached, in `unit`; NaN where there is nothing.
        par: What the reference operator reached; NaN without.
        unit: Of both.
        good, poor: All of it up to the one, none from the other on, in that unit.
        quality: Reached by what was flown, 0 to 1.
        share: Likewise, of the whole mission.
        weight: Points that it has of the score's 100.
        formula: How the share comes about, in words.
    """

    name: str
    measure: str
    value: float
    par: float
    unit: str
    good: float
    poor: float
    quality: float
    share: float
    weight: float
    formula: str

    @property
    def points(self) -> float:
        """Points that it brings."""
        return self.weight * self.share

    @property
    def lost(self) -> float:
        """Points that it costs."""
        return self.weight - self.points


class Score(NamedTuple):
    """What a flight of a mission was worth.

    Attributes:
        parts: What a mission does not ask for is not among them. Their weights add up to 100.
        reached: Share of the mission's points that were reached.
    """

    parts: tuple[Part, ...]
    reached: float

    @property
    def points(self) -> float:
        """Sum of the parts' points, 0 to 100."""
        return min(max(math.fsum(part.points for part in self.parts), 0.0), 100.0)


def score_of(mission: Mission, measures: Measures, par: Measures | None) -> Score | None:
    """Return the score of a flight; None where the mission leads nowhere, so there is nothing to be judged by.

    Args:
        mission: What was flown.
        measures: What it came to.
        par: What the reference operator came to on the same seed; None where nobody flew for reference.
    """
    if not mission.judged:
        return None
    asked = [each for each in YARDSTICKS if WHERE_ASKED.get(each.part, _always)(mission)]
    total = sum(each.weight for each in asked)
    reached = _bounded(measures.reached)
    parts = [_part(each, mission, measures, par, 100.0 * each.weight / total) for each in asked]
    return Score(tuple(parts), reached)


def shortcomings(director: Director, score: Score | None) -> tuple[str, ...]:
    """Return in words all that keeps a finished flight from being passed: the criteria, and the least score."""
    found = director.shortcomings()
    least = director.mission.criteria.min_points
    if score is not None and score.points < least:
        found.append(f"score {score.points:.1f} is under {least:g}")
    return tuple(found)


def _always(_: Mission) -> bool:
    return True


def _part(yard: Yardstick, mission: Mission, measures: Measures, par: Measures | None, weight: float) -> Part:
    value = float(getattr(measures, yard.measure))
    known = float(getattr(par, yard.measure)) if par else math.nan
    good, poor = _bounds(yard, mission, known)
    # Straight from good to poor, whichever of them is the larger number.
    quality = _bounded((poor - value) / (poor - good))
    words = f"all at {measure(good, yard.unit)}{_side(good, yard)}, none at {measure(poor, yard.unit)}"
    if yard.part == "clearance":
        words += " or with a collision"
        quality = 0.0 if measures.collisions else quality
    reached = _bounded(measures.reached) if yard.flown else 1.0
    if reached < 1.0:
        words += f"; times {reached:.0%} of the way"
    share = quality * reached
    return Part(yard.part, yard.measure, value, known, yard.unit, good, poor, quality, share, weight, words)


def _bounds(yard: Yardstick, mission: Mission, par: float) -> tuple[float, float]:
    """Return up to where a part is good and from where on it is poor."""
    limit = _limit(yard.part, mission)
    usual = UNHURRIED * limit if yard.part == "time" else yard.usual
    good = par if math.isfinite(par) else usual
    if yard.part == "clearance":
        # Touching is poor at any rate, so what is good lies beyond it.
        good = max(min(good, ROOMY_M), limit + yard.least)
    away = -1.0 if yard.rises else 1.0
    poor = limit if not math.isnan(limit) else good + away * (yard.times - 1.0) * abs(good)
    least = good + away * yard.least
    return good, min(poor, least) if yard.rises else max(poor, least)


def _limit(part: str, mission: Mission) -> float:
    """Return what the mission itself says is too much, or too little; NaN where it says nothing."""
    criteria, pad = mission.criteria, mission.landing_pad
    limits = {
        "time": criteria.time_limit_s,
        "precision": criteria.final_error_m,
        "landing": pad.radius if pad else math.nan,
        "clearance": criteria.min_clearance_m,
        "gates": 1.0,
    }
    return limits.get(part, math.nan)


def measure(value: float, unit: str) -> str:
    """Return a measure in words."""
    if math.isnan(value):
        return "not known"
    if unit == SHARE:
        return f"{value:.0%} missed"
    return f"{value:.3g} {unit}".rstrip().replace("-", "−")


def _side(good: float, yard: Yardstick) -> str:
    if yard.rises:
        return " or more"
    return " or less" if good > 0.0 else ""


def _bounded(share: float) -> float:
    """Bring a share into its bounds; what is not known is worth nothing."""
    return min(max(share, 0.0), 1.0) if not math.isnan(share) else 0.0
