"""How the figures look: one set of colours, sizes and lines, readable in print and for all kinds of colour vision."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from groundstation.recording import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Colour = tuple[float, float, float]


def _ink(colour: palette.Colour) -> Colour:
    red, green, blue = colour
    return red / 255.0, green / 255.0, blue / 255.0


# Who: what the hand wants, and what the vehicle does.
HAND = _ink(palette.ORANGE)
VEHICLE = _ink(palette.BLUE)
# Which axis: x, y, z, yaw, or forward, left, up, yaw rate.
AXES = (_ink(palette.VERMILION), _ink(palette.GREEN), _ink(palette.PURPLE), (0.35, 0.35, 0.38))
TARGET = _ink(palette.GREEN)
WIND = _ink(palette.SKY)
BAR = _ink(palette.VERMILION)
TEXT: Colour = (0.13, 0.13, 0.15)
FAINT: Colour = (0.45, 0.45, 0.48)
GRID: Colour = (0.88, 0.88, 0.89)
NEAR: Colour = (0.94, 0.91, 0.85)
HELD: Colour = (0.91, 0.95, 0.93)
OBSTACLE: Colour = (0.80, 0.80, 0.82)
OBSTACLE_EDGE: Colour = (0.50, 0.50, 0.53)

LINE, THIN, HAIR = 1.3, 0.8, 0.5
DASHED = (0, (3.0, 2.0))
# Points.
TEXT_SIZE, SMALL = 8.0, 7.0

_SETTINGS: dict[Any, Any] = {
    "font.size": TEXT_SIZE,
    "axes.labelsize": TEXT_SIZE,
    "axes.titlesize": TEXT_SIZE,
    "axes.titlelocation": "left",
    "axes.titlepad": 4.0,
    "axes.labelcolor": TEXT,
    "axes.edgecolor": FAINT,
    "axes.linewidth": HAIR,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": TEXT,
    "ytick.labelcolor": TEXT,
    "xtick.major.width": HAIR,
    "ytick.major.width": HAIR,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "text.color": TEXT,
    "lines.linewidth": LINE,
    "lines.solid_joinstyle": "round",
    "lines.solid_capstyle": "round",
    "patch.linewidth": HAIR,
    "svg.fonttype": "path",
    "svg.hashsalt": "groundstation",
    "pdf.fonttype": 42,
    "path.simplify": True,
    "path.simplify_threshold": 0.2,
    "mathtext.fontset": "dejavusans",
}


@contextmanager
def applied() -> Generator[None]:
    """Draw in this style, and save in it, without a change to what else is drawn in this process."""
    import matplotlib as mpl

    with mpl.rc_context(_SETTINGS):
        yield


def letter(axes: Axes, name: str, words: str) -> None:
    """Head a panel with its letter and what it shows."""
    axes.set_title(f"({name})  {words}", color=TEXT)


def at_end(axes: Axes, lines: Sequence[tuple[float, str, Colour]], t: float, gap: float) -> None:
    """Name lines at their right end.

    Args:
        axes: Where the lines are.
        lines: Of each the last value, its name and its colour.
        t: Where the lines end.
        gap: Least distance between two names, in the axis' units.
    """
    ordered = sorted(lines)
    heights = spread([value for value, _, _ in ordered], gap)
    for height, (_, words, colour) in zip(heights, ordered, strict=True):
        axes.annotate(
            words, (t, height), xytext=(4, 0), textcoords="offset points", color=colour, va="center",
            annotation_clip=False,
        )  # fmt: skip


def spread(ascending: Sequence[float], gap: float) -> list[float]:
    """Return heights for names, no two nearer than `gap`, in the mean where the values are."""
    heights: list[float] = []
    for value in ascending:
        heights.append(max(value, heights[-1] + gap) if heights else value)
    raised = (sum(heights) - sum(ascending)) / len(heights)
    return [height - raised for height in heights]


def name(axes: Axes, x: float, y: float, words: str, below: float = 0.0) -> None:
    """Write a name at a place, or `below` points under it, readable on any ground."""
    from matplotlib.patheffects import withStroke

    halo = withStroke(linewidth=1.8, foreground="white")
    axes.annotate(
        words, (x, y), xytext=(0.0, -below), textcoords="offset points", ha="center", va="center", fontsize=SMALL,
        path_effects=[halo], zorder=6,
    )  # fmt: skip
