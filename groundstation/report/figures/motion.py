"""Figures 9 and 10: the motion of the vehicle, in perspective, from the side and from above."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.report.figures import perspective, plane, style
from groundstation.report.figures.view import view_of
from groundstation.review.series import FlightSeries
from groundstation.training.mission import Mission

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

HEIGHT = 5.2


def draw(on: FigureBase, series: FlightSeries, mission: Mission, radius: float) -> None:
    """Draw the way flown among the mission's obstacles.

    Args:
        on: Where, empty.
        series: The flight.
        mission: What was flown.
        radius: Of the vehicle's hull, m.
    """
    view = view_of(series, mission, radius)
    panels = on.subplot_mosaic(
        [["space", "space"], ["side", "above"], ["key", "above"]], height_ratios=[3.2, 1.35, 0.75]
    )
    perspective.draw(panels["space"], view)
    plane.from_the_side(panels["side"], view)
    plane.from_above(panels["above"], view)
    _key(panels["key"], panels["above"])
    style.letter(panels["space"], "a", "in perspective")
    style.letter(panels["side"], "b", "from the side")
    style.letter(panels["above"], "c", "from above")


def _key(axes: Axes, shown: Axes) -> None:
    """Name what the views show, in a place of its own."""
    axes.set_axis_off()
    handles, names = shown.get_legend_handles_labels()
    axes.legend(handles, names, ncols=2, loc="center", frameon=False, fontsize=style.SMALL, handlelength=1.8)
