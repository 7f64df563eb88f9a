"""A score in lines of text: what every part was held against, and where points were lost."""

from __future__ import annotations

import math
from collections.abc import Iterator

from groundstation.training.judgement import Judgement
from groundstation.training.score import NO_PAR, Score, measure
from groundstation.training.story import clock, worth_telling

NAME = 15


def told(judgement: Judgement, par_from: str, start: float | None = None) -> Iterator[str]:
    """Yield a score in lines for people: its parts with what each was held against, and where points were lost.

    Args:
        judgement: Of the flight.
        par_from: Whose flight it is held against, in words, or "".
        start: When the recording begins, s on the clock of the flight: then it is told where `review --at` finds it.
    """
    score = judgement.score
    if score is None:
        return
    yield f"{'score':<{NAME}} {score.points:.1f} of 100, held against {par_from or NO_PAR}"
    for part in score.parts:
        par = f", par {measure(part.par, part.unit)}" if math.isfinite(part.par) else ""
        reached = f"{part.points:4.1f} of {part.weight:4.1f}"
        yield f"  {part.name:<{NAME - 2}} {reached}  {measure(part.value, part.unit)}{par}; {part.formula}"
    for index, moment in enumerate(worth_telling(judgement.story)):
        t = clock(moment.t - judgement.took_off_t)
        where = "" if start is None else f" (--at {moment.t - start:.1f})"
        name = "" if index else "points lost"
        yield f"{name:<{NAME}} {f'−{moment.lost:.1f}':>5} at {t}{where}, {moment.part}: {moment.words}"


def so_far(score: Score) -> str:
    """Return a score that still grows in one line: what was reached of each part's weight."""
    parts = (f"{part.name} {part.points:.0f}/{part.weight:.0f}" for part in score.parts)
    return f"{score.points:.0f} of 100 so far: {', '.join(parts)}"


class Landings:
    """Tells each flight's verdict and score once, when it has landed.

    Args:
        par_from: Whose flight it is held against, in words, or "".
    """

    def __init__(self, par_from: str) -> None:
        self._par_from = par_from
        self._told: Judgement | None = None

    def news(self, judgement: Judgement | None) -> Iterator[str]:
        """Yield lines on the last flight that landed, unless they were told already."""
        if judgement is None or judgement is self._told or judgement.score is None:
            return
        self._told = judgement
        yield (
            f"Landed, NOT passed: {'; '.join(judgement.shortcomings)}."
            if judgement.shortcomings
            else "Passed."
        )
        yield from told(judgement, self._par_from)
