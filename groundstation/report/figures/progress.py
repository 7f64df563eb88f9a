"""Scores of every pilot, flight by flight, in a small panel each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from groundstation.report.figures import style

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

_COLUMNS = 3
_ROW_HEIGHT = 1.35


def height(pilots: int) -> float:
    """Return the figure's height, inches."""
    return 0.3 + _ROW_HEIGHT * -(-pilots // _COLUMNS)


def draw(on: FigureBase, scores: Mapping[str, Sequence[float]], low: float) -> None:
    """Draw a panel for each pilot.

    Args:
        on: Where, empty.
        scores: By pilot, in the order they were flown, 0 to 100.
        low: Where a line is drawn.
    """
    rows = -(-len(scores) // _COLUMNS)
    panels = on.subplots(rows, _COLUMNS, sharex=True, sharey=True, squeeze=False).flatten()
    for axes in panels[len(scores) :]:
        axes.set_axis_off()
    for axes, (name, values) in zip(panels, scores.items(), strict=False):
        axes.plot(range(1, len(values) + 1), values, "o-", color=style.VEHICLE, markersize=3.5)
        axes.axhline(low, color=style.BAR, linewidth=style.THIN, linestyle=style.DASHED)
        axes.set_ylim(0.0, 104.0)
        axes.set_title(name)
        axes.xaxis.get_major_locator().set_params(integer=True)
