"""The figure of an evaluation: a panel for each of the main figures, along the axis that was varied."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from groundstation.evaluation.case import Result
from groundstation.evaluation.comparison import (
    CONDITIONS,
    METRICS,
    Flights,
    Subject,
    average,
    completed,
    subjects,
)
from groundstation.evaluation.intervals import Interval
from groundstation.evaluation.words import labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Colour-blind safe (Okabe and Ito 2008).
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_MARKERS = "os^Dv<>"
_TITLES = {"delay": "round trip, s", "loss": "share lost", "jitter": "jitter, s", "wind": "wind"}
# What is drawn along, the first of them that was varied.
_ALONG = ("delay", "loss", "jitter", "wind", "operator", "mission", "rate")
_COLUMNS = 5
# How far apart subjects are drawn, as a share of the axis.
_DODGE = 0.02


def draw(path: Path, results: Sequence[Result]) -> None:
    """Draw the figure, as the suffix says (SVG, PNG, PDF)."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    flights = subjects(results)
    along = varied(flights)
    names = ["completed", *(metric.name for metric in METRICS)]
    height = -(-len(names) // _COLUMNS)
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "groundstation", "font.size": 9}):
        figure = Figure(figsize=(3.2 * _COLUMNS, 2.6 * height))
        figure.subplots_adjust(0.04, 0.15, 0.99, 0.89, wspace=0.25, hspace=0.55)
        for panel, name in zip(figure.subplots(height, _COLUMNS).flat, names, strict=True):
            _panel(panel, name, flights, along)
        handles, words = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, words, loc="lower center", ncols=min(len(words), 5), frameon=False)
        figure.suptitle(f"{len(results)} flights; mean over seeds, bars: 95 % confidence")
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def varied(flights: dict[Subject, Flights]) -> str:
    """Return the axis to draw along: the first that has more than one value, else the delay."""
    keys = [key for each in flights.values() for key in each]
    for name in _ALONG:
        if len({key[CONDITIONS.index(name)] for key in keys}) > 1:
            return name
    return "delay"


def _panel(panel: Axes, name: str, flights: dict[Subject, Flights], along: str) -> None:
    place = CONDITIONS.index(along)
    values = list(dict.fromkeys(key[place] for each in flights.values() for key in each))
    places = _places(values)
    step = _DODGE * (max(places.values()) - min(places.values()) or 1.0)
    for number, (subject, label) in enumerate(labels(tuple(flights)).items()):
        offset = step * (number - 0.5 * (len(flights) - 1))
        mine = flights[subject]
        points = [
            (x + offset, _estimate(name, {key: each for key, each in mine.items() if key[place] == value}))
            for value, x in places.items()
        ]
        points = [(x, interval) for x, interval in points if not math.isnan(interval.value)]
        below = [0.0 if math.isnan(i.low) else i.value - i.low for _, i in points]
        above = [0.0 if math.isnan(i.high) else i.high - i.value for _, i in points]
        panel.errorbar(
            [x for x, _ in points],
            [interval.value for _, interval in points],
            (below, above),
            color=_COLOURS[number % len(_COLOURS)],
            marker=_MARKERS[number % len(_MARKERS)],
            markersize=4,
            capsize=2,
            linewidth=1,
            label=label,
        )
    unit = next((metric.unit for metric in METRICS if metric.name == name), "")
    panel.set_title(f"{name}, {unit}" if unit else name, fontsize=9)
    panel.set_xticks(list(places.values()), [f"{v:g}" if isinstance(v, float) else str(v) for v in places])
    panel.set_xlabel(_TITLES.get(along, along))
    panel.grid(alpha=0.3)


def _places(values: Sequence[Hashable]) -> dict[Hashable, float]:
    """Return where each value lies: numbers to scale, names one after the other."""
    return {value: value if isinstance(value, float) else float(spot) for spot, value in enumerate(values)}


def _estimate(name: str, flights: Flights) -> Interval:
    if name == "completed":
        return completed(flights)
    return average(flights, next(metric for metric in METRICS if metric.name == name))
