"""How the simulated operators fare in missions, as a table of text: a line each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean
from typing import NamedTuple

from groundstation.operators.exercise import NOBODY, Flown
from groundstation.training.mission import Mission
from sim.people import PEOPLE

_COLUMN = 18


class Standing(NamedTuple):
    """A mission with the flights it was measured by, and why they make no par, or ""."""

    mission: Mission
    flown: Sequence[Flown]
    fault: str


def table(standings: Sequence[Standing]) -> str:
    """Return for each mission how many flights of whom passed and the mean time, s; then what is wrong, in words."""
    name_width = max(len("mission"), *(len(standing.mission.name) for standing in standings))
    head = (
        "mission".ljust(name_width) + "".join(f"  {name:<{_COLUMN}}" for name in PEOPLE) + "  doing nothing"
    )
    lines = [head.rstrip()]
    for mission, flown, _ in standings:
        cells = [
            f"  {_cell([each for each in flown if each.operator == name]):<{_COLUMN}}" for name in PEOPLE
        ]
        idle = all(each.shortcomings for each in flown if each.operator == NOBODY)
        lines.append(mission.name.ljust(name_width) + "".join(cells) + ("  fails" if idle else "  passes"))
    lines += [f"{mission.name}: {fault}." for mission, _, fault in standings if fault]
    return "\n".join(lines)


def _cell(flown: Sequence[Flown]) -> str:
    passed = sum(not each.shortcomings for each in flown)
    times = [each.measures.time_s for each in flown if math.isfinite(each.measures.time_s)]
    return f"{passed}/{len(flown)} {fmean(times):6.1f} s" if times else f"{passed}/{len(flown)}"
