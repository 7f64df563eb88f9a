"""What an evaluation tells in the end, as plain text: who did how well, and what differs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Sequence

from groundstation.evaluation.case import Result
from groundstation.evaluation.comparison import (
    CONDITIONS,
    METRICS,
    Flights,
    Metric,
    Subject,
    average,
    completed,
    difference,
    discordant,
    subjects,
)
from groundstation.evaluation.intervals import Interval

_UNITS = {"delay": " s", "jitter": " s", "rate": " Hz"}
_RMS = next(metric for metric in METRICS if metric.name == "RMS error")
_NONE = "–"
_GAP = "   "


def comparison(results: Sequence[Result], width: int) -> str:
    """Return the comparison in lines no wider than `width`, as far as one column fits into it."""
    flights = subjects(results)
    names = labels(tuple(flights))
    seeds = len({result.case.seed for result in results})
    parts = [
        f"{len(results)} flights, {seeds} {'seed' if seeds == 1 else 'seeds'}; ± and ranges: 95 % confidence"
    ]
    parts += _tables(_absolute(flights, names), width)
    if len(flights) > 1:
        parts += _tables(_relative(flights, names), width)
        parts.append("* the interval leaves out zero; differences are within the same condition and seed")
    for place, name in enumerate(CONDITIONS):
        values = list(dict.fromkeys(key[place] for each in flights.values() for key in each))
        if len(values) > 1:
            parts += _tables(_by_condition(flights, names, place, name, values), width)
    return "\n\n".join(parts)


def labels(found: Sequence[Subject]) -> dict[Subject, str]:
    """Return what to call each subject: its controller, with its guard where it has flown with several."""
    often = Counter(subject.controller for subject in found)
    return {
        subject: subject.controller
        if often[subject.controller] == 1
        else f"{subject.controller}, {subject.guard}"
        for subject in found
    }


def _absolute(flights: dict[Subject, Flights], names: dict[Subject, str]) -> list[list[str]]:
    rows = [["", *names.values()]]
    rows.append(["completed", *(_rate(completed(each), each) for each in flights.values())])
    rows += [
        [metric.name, *(_figure(average(each, metric), metric) for each in flights.values())]
        for metric in METRICS
    ]
    return rows


def _relative(flights: dict[Subject, Flights], names: dict[Subject, str]) -> list[list[str]]:
    (first, base), *others = flights.items()
    rows = [["difference", *(f"{names[subject]} − {names[first]}" for subject, _ in others)]]
    only = (discordant(each, base) for _, each in others)
    rows.append(["completed", *(f"{gained} won, {lost} lost" for lost, gained in only)])
    for metric in METRICS:
        found = (difference(each, base, metric) for _, each in others)
        rows.append([metric.name, *(_figure(each, metric, signed=True) for each in found)])
    return rows


def _by_condition(
    flights: dict[Subject, Flights],
    names: dict[Subject, str],
    place: int,
    name: str,
    values: Sequence[Hashable],
) -> list[list[str]]:
    rows = [[f"by {name}", *names.values()]]
    for value in values:
        cells: list[str] = []
        for each in flights.values():
            some = {key: outcome for key, outcome in each.items() if key[place] == value}
            done = sum(outcome.completed for outcome in some.values())
            cells.append(f"{done}/{len(some)}, RMS {_figure(average(some, _RMS), _RMS)}")
        rows.append([f"{value:g}{_UNITS.get(name, '')}" if isinstance(value, float) else str(value), *cells])
    return rows


def _rate(rate: Interval, flights: Flights) -> str:
    done = sum(outcome.completed for outcome in flights.values())
    return f"{done}/{rate.size} ({100 * rate.low:.0f}–{100 * rate.high:.0f} %)"


def _figure(interval: Interval, metric: Metric, *, signed: bool = False) -> str:
    if math.isnan(interval.value):
        return _NONE
    digits, unit = metric.digits, f" {metric.unit}" if metric.unit else ""
    value = f"{interval.value:{'+' if signed else ''}.{digits}f}".replace("-", "−")
    spread = "" if math.isnan(interval.half) else f" ± {interval.half:.{digits}f}"
    return f"{value}{spread}{unit}{' *' if signed and interval.leaves_out_zero else ''}"


def _tables(rows: list[list[str]], width: int) -> list[str]:
    """Lay rows out in columns; what does not fit beside the first column comes in another table below."""
    sizes = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    tables: list[list[int]] = []
    for column in range(1, len(sizes)):
        used = sum(sizes[each] + len(_GAP) for each in tables[-1]) if tables else width
        if used + sizes[column] + len(_GAP) > width:
            tables.append([0])
        tables[-1].append(column)
    return [
        "\n".join(_GAP.join(row[each].ljust(sizes[each]) for each in table).rstrip() for row in rows)
        for table in tables
    ]
