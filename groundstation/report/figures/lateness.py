"""How late things were: age of the state, of the handle, round trip, silence, over the whole flight."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from groundstation.report.figures import style
from groundstation.review.flight import Series

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

HEIGHT = 2.5
_LEAST_S = 1e-3
_POINTS = 1200


def draw(on: FigureBase, delays: Mapping[str, Series]) -> None:
    """Draw delays over the flight's time, the largest of each stretch, on a scale of powers of ten.

    Args:
        on: Where, empty.
        delays: By name, one column each, s.
    """
    from matplotlib.ticker import StrMethodFormatter

    axes = on.subplots()
    axes.grid(visible=True, color=style.GRID, linewidth=style.HAIR)
    for (name, (t, values)), colour in zip(
        delays.items(), (style.HAND, style.VEHICLE, *style.AXES), strict=False
    ):
        known = np.isfinite(values[:, 0])
        times, largest = peaks(t[known], values[known, 0])
        axes.plot(times, np.maximum(largest, _LEAST_S), color=colour, linewidth=style.THIN, label=name)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_ylabel("s")
    axes.set_xlabel("time since the start, s")
    axes.legend(ncols=4, frameon=False, loc="upper right")


def peaks(t: np.ndarray, values: np.ndarray, most: int = _POINTS) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest value of each of at most `most` stretches, at its first time."""
    every = max(1, -(-len(t) // most))
    starts = np.arange(0, len(t), every)
    if not len(starts):
        return t, values
    return t[starts], np.maximum.reduceat(values, starts)
