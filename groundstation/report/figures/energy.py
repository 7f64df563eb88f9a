"""The ledger of the haptic port: what the hand gave and was given back, and what was taken out of the force."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.report.figures import style
from groundstation.review.flight import Series

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

HEIGHT = 2.6
_POINTS = 3000


def draw(on: FigureBase, energy: Series) -> None:
    """Draw account and dissipation over the flight's time, mJ.

    Args:
        on: Where, empty.
        energy: Columns account and dissipated, J.
    """
    upper, lower = on.subplots(2, 1, sharex=True)
    t, values = energy
    every = max(1, len(t) // _POINTS)
    for axes, column, colour, words in (
        (upper, 0, style.HAND, "account, mJ"),
        (lower, 1, style.VEHICLE, "taken out, mJ"),
    ):
        axes.grid(visible=True, color=style.GRID, linewidth=style.HAIR)
        axes.plot(t[::every], 1e3 * values[::every, column], color=colour, linewidth=style.THIN)
        axes.set_ylabel(words)
    upper.axhline(0.0, color=style.FAINT, linewidth=style.HAIR)
    lower.set_xlabel("time since the start, s")
