"""How the simulated operators stand in missions, as a table of text: a line each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean

from groundstation.operators.exercise import NOBODY
from groundstation.operators.standing import Marked, Standing
from sim.people import PEOPLE

_CELL = 20


def table(standings: Sequence[Standing]) -> str:
    """Return for each mission how many flights of whom passed, their mean points and time; then each fault."""
    name_width = max(len("mission"), *(len(standing.mission.name) for standing in standings))
    lines = [
        "mission".ljust(name_width) + "".join(f"  {name:<{_CELL}}" for name in PEOPLE) + "  doing nothing"
    ]
    for standing in standings:
        cells = "".join(f"  {_cell(standing.of(name)):<{_CELL}}" for name in PEOPLE)
        idle = "fails" if all(each.lacks for each in standing.of(NOBODY)) else "passes"
        lines.append(f"{standing.mission.name:<{name_width}}{cells}  {idle}")
    lines.append("Passed of flown, mean points of 100, mean time from take-off to landing.")
    lines += [f"{standing.mission.name}: {standing.fault}." for standing in standings if standing.fault]
    return "\n".join(lines)


def _cell(marked: Sequence[Marked]) -> str:
    passed = sum(not each.lacks for each in marked)
    times = [each.flown.measures.time_s for each in marked]
    mean = (
        fmean(time for time in times if math.isfinite(time)) if any(map(math.isfinite, times)) else math.nan
    )
    return f"{passed}/{len(marked)} {fmean(each.points for each in marked):4.0f} {mean:7.1f} s"
