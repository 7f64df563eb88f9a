"""A mission's score: from 0 to 100, part by part, each with its formula. `docs/report.md` explains them."""

from __future__ import annotations

import math
from typing import NamedTuple

from groundstation.training.director import Figures
from groundstation.training.mission import Mission

# Further from obstacles than this nothing is gained, m.
ROOMY_M = 0.5
# A hand that is this far ahead of the drone in the mean scores nothing for following, m.
LOST_M = 1.0
# Quicker than this share of the time limit nothing is gained: nobody shall race.
UNHURRIED = 0.5


class Part(NamedTuple):
    """One part of a score.

    Attributes:
        name: Of what is judged.
        share: Reached, 0 to 1.
        formula: How the share comes about, in words.
    """

    name: str
    share: float
    formula: str


class Score(NamedTuple):
    """What a flight of a mission was worth.

    Attributes:
        parts: All weigh the same; what a mission does not ask for is not among them.
    """

    parts: tuple[Part, ...]

    @property
    def points(self) -> float:
        """Mean of the parts, 0 to 100."""
        return 100.0 * sum(part.share for part in self.parts) / len(self.parts)


def score_of(mission: Mission, figures: Figures) -> Score | None:
    """Return the score of a flight; None where the mission has no target, so nothing to be judged by.

    Args:
        mission: What was flown.
        figures: What it came to.
    """
    if not mission.judged:
        return None
    criteria = mission.criteria
    limit, allowed = criteria.time_limit_s, criteria.final_error_m
    reached = not math.isnan(figures.final_error)
    parts = [
        Part(
            "precision",
            _share(1.0 - figures.final_error / allowed) if reached else 0.0,
            f"1 at the target, 0 at {allowed:g} m from it when the hold ends, or never held",
        ),
        Part(
            "time",
            _share((limit - figures.duration) / (limit * (1.0 - UNHURRIED))) if reached else 0.0,
            f"1 up to {UNHURRIED * limit:g} s from take-off to landing, 0 from {limit:g} s on, or never held",
        ),
        Part(
            "following",
            _share(1.0 - figures.rms_error / LOST_M) if figures.error_count else 0.0,
            f"1 − RMS of p̃ / {LOST_M:g} m",
        ),
    ]
    if mission.obstacle:
        parts.append(
            Part(
                "clearance",
                0.0 if figures.collisions else _share(figures.least_clearance / ROOMY_M),
                f"least clearance / {ROOMY_M:g} m, at most 1; 0 with a collision",
            )
        )
    if figures.gates:
        parts.append(
            Part("gates", 1.0 - figures.gates_missed / figures.gates, "share of the gates flown through")
        )
    return Score(tuple(parts))


def _share(value: float) -> float:
    """Bring a share into its bounds; what is not known is worth nothing."""
    return min(max(value, 0.0), 1.0) if not math.isnan(value) else 0.0
