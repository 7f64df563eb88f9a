"""The last moments as curves: the paper's figures 11 (force), 12 (error) and 13 (velocities), live."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.tui.canvas import Canvas
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row
from groundstation.tui.theme import Tone
from groundstation.tui.track import History
from groundstation.tui.widgets.instrument import Instrument

Floats = NDArray[np.float64]

_LEAST_ROWS = 6
_RANGES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
_LABEL = 7


@dataclass(frozen=True, slots=True)
class Curve:
    """One curve of a chart: its column in the history, its name and looks."""

    column: int
    name: str
    tone: Tone
    dotted: bool = False


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves on one scale."""

    title: str
    unit: str
    curves: tuple[Curve, ...]


def _pair(title: str, axis: int) -> Chart:
    meant = Curve(History.MEANT + axis, "v_c", Tone.HAND, dotted=True)
    return Chart(title, "m/s", (meant, Curve(History.FLOWN + axis, "flown", Tone.VEHICLE)))


def _triple(title: str, unit: str, first: int, letters: tuple[str, str, str]) -> Chart:
    tones = (Tone.VEHICLE, Tone.HAND, Tone.OK)
    curves = (Curve(first + index, letter, tones[index]) for index, letter in enumerate(letters))
    return Chart(title, unit, tuple(curves))


CHARTS = (
    _pair("velocity forward", 0),
    _pair("velocity left", 1),
    _triple("position error", "m", History.ERROR, ("x", "y", "z")),
    _triple("force on the hand", "N", History.FORCE, ("x", "y", "z")),
    _pair("velocity up", 2),
)


class Curves(Instrument):
    """As many charts as there is room for, one under the other."""

    BORDER_TITLE = f"last {History.SPAN_S:.0f} s"
    EVERY = 6

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the charts."""
        table = frame.history.rows()
        count = max(min(len(CHARTS), height // _LEAST_ROWS), 1)
        rows: list[Row] = []
        for index in range(count):
            share = (height * (index + 1)) // count - (height * index) // count
            rows.extend(draw_chart(CHARTS[index], table, frame.now, width, share))
        return rows


def draw_chart(chart: Chart, table: Floats, now: float, width: int, height: int) -> list[Row]:
    """Return a chart as rows: a heading, then the curves with their scale to the left.

    Args:
        chart: What is drawn.
        table: Samples, see `History`, shape (n, 13).
        now: At the right edge, s.
        width: Cells.
        height: Rows with the heading.
    """
    heading: Row = [(f" {chart.title}", Tone.TEXT)]
    for curve in chart.curves:
        heading.append((f"  {'┄' if curve.dotted else '─'} {curve.name}", curve.tone))
    canvas = Canvas(max(width - _LABEL, 1), max(height - 1, 1))
    values = table[:, [curve.column for curve in chart.curves]]
    known = np.abs(values[np.isfinite(values)])
    reach = float(known.max()) if known.size else 0.0
    top = next((top for top in _RANGES if top >= reach), _RANGES[-1])
    x = canvas.width - 1 - (now - table[:, History.TIME]) * (canvas.width / History.SPAN_S)
    middle = (canvas.height - 1) / 2
    canvas.line([0, canvas.width - 1], [middle, middle], Tone.GRID, gap=3)
    across = np.arange(canvas.width, dtype=float)
    for index, curve in enumerate(chart.curves):
        if len(x):
            y = np.interp(across, x, middle - values[:, index] / top * middle, left=np.nan, right=np.nan)
            _curve(canvas, across, y, curve)
    return [heading, *_with_scale(canvas.to_rows(), top, chart.unit)]


def _curve(canvas: Canvas, x: Floats, y: Floats, curve: Curve) -> None:
    """Plot a dot a column, and join them where they are apart, unless the curve is a dotted one."""
    if curve.dotted:
        canvas.plot(x, y, curve.tone)
        return
    steps = np.linspace(0.0, 1.0, 5)
    joined = y[:-1, None] + np.diff(y)[:, None] * steps
    canvas.plot(np.repeat(x[:-1], len(steps)), joined.ravel(), curve.tone)
    if np.isfinite(y[-2]) and len(curve.name) == 1:
        canvas.letters(canvas.columns - 1, int(y[-2]) // 4, curve.name, curve.tone)


def _with_scale(rows: list[Row], top: float, unit: str) -> list[Row]:
    labels = {0: f"{top:+g}", len(rows) // 2: unit, len(rows) - 1: f"−{top:g}"}
    return [[(f"{labels.get(index, ''):>{_LABEL - 1}} ", Tone.MUTED), *row] for index, row in enumerate(rows)]
