"""Figure 12: the errors in the working space, toward the target and the controller's own, and that they converge."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from groundstation.report.figures import over_time, style
from groundstation.review.series import FlightSeries, Numbers, lengths
from groundstation.training.mission import Target

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

HEIGHT = 4.6
# What is less than this is drawn as this, m: no simulated hand is steadier.
_LEAST_M = 0.001


def draw(on: FigureBase, series: FlightSeries, target: Target, bar: float) -> None:
    """Draw target − p by axis, and below it the distances on a scale of powers of ten.

    Args:
        on: Where, empty.
        series: The flight, up to the end of the hold.
        target: Where it leads.
        bar: What the final distance is to be at most, m.
    """
    to_target = np.array(target.position) - series.p[:, :3]
    upper, lower = on.subplots(2, 1, sharex=True, height_ratios=[1.0, 1.15])
    over_time.prepare((upper, lower), series.t)
    _by_axis(upper, series.t, to_target)
    _distances(lower, series, lengths(to_target), bar)
    for axes in (upper, lower):
        axes.axvspan(series.t[-1] - target.hold_s, series.t[-1], color=style.HELD, linewidth=0.0, zorder=0)
    style.letter(upper, "a", "from the vehicle to the target $p_d$, by axis")
    style.letter(lower, "b", "the same as a distance, and the controller's own error")


def _by_axis(axes: Axes, t: Numbers, to_target: Numbers) -> None:
    over_time.zero(axes)
    for axis, (name, colour) in enumerate(zip("xyz", style.AXES, strict=False)):
        axes.plot(t, to_target[:, axis], color=colour, label=f"${name}$")
    axes.set_ylabel("$p_d - p$, m")
    axes.legend(ncols=3, frameon=False, loc="upper right")


def _distances(axes: Axes, series: FlightSeries, distance: Numbers, bar: float) -> None:
    from matplotlib.ticker import StrMethodFormatter

    axes.set_yscale("log")
    for lengths_m, colour, width, name in (
        (lengths(series.error), style.HAND, style.THIN, r"controller: $|\tilde{p}| = |p_h - p|$"),
        (distance, style.VEHICLE, style.LINE, "target: $|p_d - p|$"),
    ):
        axes.plot(series.t, np.maximum(lengths_m, _LEAST_M), color=colour, linewidth=width, label=name)
    axes.axhline(bar, color=style.BAR, linewidth=style.THIN, linestyle=style.DASHED)
    axes.annotate(
        f"{bar:g} m", (series.t[-1], bar), xytext=(4, 0), textcoords="offset points", va="center",
        color=style.BAR, fontsize=style.SMALL, annotation_clip=False,
    )  # fmt: skip
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_ylabel("distance, m")
    axes.legend(ncols=2, frameon=False, loc="upper right")
