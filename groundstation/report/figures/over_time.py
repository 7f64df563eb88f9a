"""What the curves over time share: the time axis, and the times in which an obstacle was near."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from groundstation.report.figures import style
from groundstation.review.series import Approach, Numbers

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# A name needs some room, as a share of the whole time.
_ROOM = 0.02


def prepare(panels: Sequence[Axes], t: Numbers) -> None:
    """Give panels, the lowest last, their grid and one axis of time."""
    for panel in panels:
        panel.grid(visible=True, color=style.GRID, linewidth=style.HAIR)
        panel.set_xlim(t[0], t[-1])
    panels[-1].set_xlabel("time since the hand was coupled, s")


def zero(axes: Axes) -> None:
    """Draw a line at zero."""
    axes.axhline(0.0, color=style.FAINT, linewidth=style.HAIR)


def shade(axes: Axes, near: Iterable[Approach], *, named: bool = False) -> None:
    """Shade the times in which an obstacle was near, and write its name above where they begin."""
    first, last = axes.get_xlim()
    for start, end, words, _ in near:
        axes.axvspan(start, end, color=style.NEAR, linewidth=0.0, zorder=0)
        if named and end - start > _ROOM * (last - first):
            axes.text(
                start, 1.01, words, transform=axes.get_xaxis_transform(), ha="left", va="bottom",
                fontsize=style.SMALL, color=style.FAINT,
            )  # fmt: skip
