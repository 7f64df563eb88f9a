"""Several flights over one another: their ways, and their curves over the time since coupling."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from groundstation.report.figures import outlines, style
from groundstation.review.series import FlightSeries, lengths
from groundstation.training.mission import Mission
from sim.environment.shapes import primitives

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

WAYS_HEIGHT, CURVES_HEIGHT = 4.4, 6.0
_COLOURS = (style.HAND, style.VEHICLE, *style.AXES)
# By more than colour: a line's pattern too.
_PATTERNS = (
    "-",
    (0, (5.0, 1.5)),
    (0, (1.0, 1.2)),
    (0, (5.0, 1.5, 1.0, 1.5)),
    (0, (8.0, 2.0)),
    (0, (2.0, 3.0)),
)
_DRAWN_M = 3.0
Flights = Sequence[tuple[str, FlightSeries]]


def draw_ways(on: FigureBase, flights: Flights, mission: Mission | None) -> None:
    """Draw the ways from above and from the side, to scale, with the obstacles of a mission."""
    above, side = on.subplots(2, 1, height_ratios=[1.6, 1.0], sharex=True)
    for axes, plane, outline in (
        (above, (0, 1), outlines.from_above),
        (side, (0, 2), outlines.from_the_side),
    ):
        for obstacle in mission.obstacle if mission else ():
            for part in primitives(obstacle):
                axes.fill(
                    *outline(part).T, facecolor=style.OBSTACLE, edgecolor=style.OBSTACLE_EDGE, alpha=0.8
                )
        for place, (name, series) in enumerate(flights):
            _line(axes, series.p[:, plane[0]], series.p[:, plane[1]], place, name)
        axes.set_aspect("equal", adjustable="datalim")
    above.set_ylabel("y north, m")
    side.set_ylabel("z up, m")
    side.set_xlabel("x east, m")
    above.legend(frameon=False, ncols=len(flights), loc="upper right")


def draw_curves(on: FigureBase, flights: Flights) -> None:
    """Draw error, force, clearance and speed over time."""
    panels = on.subplots(4, 1, sharex=True)
    names = ("p̃, m", "force, N", "clearance, m", "speed, m/s")
    for place, (flight, series) in enumerate(flights):
        near = np.minimum(series.clearance, _DRAWN_M)
        curves = (lengths(series.error), lengths(series.force), near, lengths(series.executed))
        for axes, curve in zip(panels, curves, strict=True):
            _line(axes, series.t, curve, place, flight)
    for axes, name in zip(panels, names, strict=True):
        axes.set_ylabel(name)
        axes.set_ylim(bottom=0.0)
        axes.grid(visible=True, color=style.GRID, linewidth=style.HAIR)
    panels[0].legend(frameon=False, ncols=len(flights), loc="upper right")
    panels[-1].set_xlabel("time since the hand was coupled, s")
    on.align_ylabels(panels)


def _line(axes: Axes, x: np.ndarray, y: np.ndarray, place: int, name: str) -> None:
    axes.plot(x, y, color=_COLOURS[place], linestyle=_PATTERNS[place], label=name)
