"""Figure 11: the fictitious force on the operator, and the obstacles that were near."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from groundstation.report.figures import over_time, style
from groundstation.review.series import FlightSeries, approaches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

HEIGHT = 3.8
# From the hull: so near an obstacle counts, m; and so much of the clearance is drawn.
NEAR_M, _DRAWN_M = 1.0, 3.0


def draw(on: FigureBase, series: FlightSeries) -> None:
    """Draw the force by axis, as equation (5) gives it and as the hand felt it, above the clearance."""
    near = list(approaches(series, NEAR_M))
    upper, lower = on.subplots(2, 1, sharex=True, height_ratios=[2.0, 1.0])
    over_time.prepare((upper, lower), series.t)
    over_time.shade(upper, near, named=True)
    over_time.shade(lower, near)
    _parts(upper, series)
    _clearance(lower, series)


def _parts(axes: Axes, series: FlightSeries) -> None:
    fictitious = series.cues["position"]
    most = 1.1 * float(max(np.abs(series.force).max(), np.abs(fictitious).max()))
    over_time.zero(axes)
    for axis, colour in enumerate(style.AXES[:3]):
        axes.plot(series.t, series.force[:, axis], color=colour, linewidth=style.HAIR, alpha=0.6)
        axes.plot(series.t, fictitious[:, axis], color=colour)
    ends = [
        (float(fictitious[-1, axis]), f"$f_{name}$", colour)
        for axis, (name, colour) in enumerate(zip("xyz", style.AXES, strict=False))
    ]
    axes.set_ylim(-most, most)
    style.at_end(axes, ends, float(series.t[-1]), 0.16 * most)
    axes.set_ylabel("force, N")


def _clearance(axes: Axes, series: FlightSeries) -> None:
    axes.plot(series.t, np.minimum(series.clearance, _DRAWN_M), color=style.VEHICLE)
    axes.axhline(NEAR_M, color=style.FAINT, linewidth=style.THIN, linestyle=style.DASHED)
    axes.set_ylim(0.0, _DRAWN_M)
    axes.set_ylabel("clearance, m")
