"""What the force on the hand is made of: the strength of each cue over time, and the obstacles that were near."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.report.figures import over_time, style
from groundstation.report.figures.force import NEAR_M
from groundstation.review.series import FlightSeries, approaches, lengths

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

HEIGHT = 2.7
# A cue that is never stronger is not drawn, N: no hand feels it.
_FELT_N = 0.2
_COLOURS = {
    "position": style.HAND,
    "environment": style.AXES[0],
    "guard": style.AXES[1],
    "mismatch": style.AXES[2],
    "damping": style.AXES[3],
    "guidance": style.VEHICLE,
}


def felt(series: FlightSeries) -> list[str]:
    """Return the cues that can be felt somewhere in a flight."""
    return [name for name, force in series.cues.items() if lengths(force).max() > _FELT_N]


def draw(on: FigureBase, series: FlightSeries) -> None:
    """Draw the norm of every cue that can be felt."""
    axes = on.subplots()
    over_time.prepare([axes], series.t)
    over_time.shade(axes, approaches(series, NEAR_M), named=True)
    for name in felt(series):
        axes.plot(series.t, lengths(series.cues[name]), color=_COLOURS[name], label=name)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("strength, N")
    axes.legend(frameon=False, loc="upper right")
