"""Figure 13: the velocities that the operator refers to, those that the robot executes, and the wind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from groundstation.report.figures import over_time, style
from groundstation.review.series import FlightSeries

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

HEIGHT = 6.2
_HEIGHTS = (1.2, 1.2, 0.8, 0.8, 0.9)
_PARTS = (("forward", "m/s"), ("left", "m/s"), ("up", "m/s"), ("yaw rate", "rad/s"))


def draw(on: FigureBase, series: FlightSeries) -> None:
    """Draw reference and executed velocity on each of the vehicle's axes, above the wind where it is known."""
    known = bool(np.isfinite(series.wind).all())
    heights = _HEIGHTS if known else _HEIGHTS[:4]
    panels = on.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    over_time.prepare(panels, series.t)
    for part, axes in enumerate(panels[:4]):
        _part(axes, series, part)
    if known:
        _wind(panels[4], series)
    panels[0].legend(ncols=2, frameon=False, loc="upper right")
    on.align_ylabels(panels)


def _part(axes: Axes, series: FlightSeries, part: int) -> None:
    name, unit = _PARTS[part]
    over_time.zero(axes)
    axes.plot(series.t, series.v_ref[:, part], color=style.HAND, label=r"reference, $v_\mathrm{ref}$")
    axes.plot(series.t, series.executed[:, part], color=style.VEHICLE, label="executed, $v$")
    axes.set_ylabel(f"{name}\n{unit}")


def _wind(axes: Axes, series: FlightSeries) -> None:
    over_time.zero(axes)
    ends: list[tuple[float, str, style.Colour]] = []
    for axis, (name, colour) in enumerate(zip(("east", "north", "up"), style.AXES, strict=False)):
        axes.plot(series.t, series.wind[:, axis], color=colour)
        ends.append((float(series.wind[-1, axis]), name, colour))
    low, high = axes.get_ylim()
    style.at_end(axes, ends, float(series.t[-1]), 0.2 * (high - low))
    axes.set_ylabel("wind\nm/s")
