"""Tapes: scales that move past a mark, for heading and for altitude and climb. Pure."""

from __future__ import annotations

import math

from groundstation.frames import heading_from_yaw
from groundstation.tui.rows import UNKNOWN, Row, joined
from groundstation.tui.theme import Tone

# Degrees a cell, and how far apart the figures are.
_DEGREES, _STEP = 3, 30
_POINTS = {0: "N", 90: "E", 180: "S", 270: "W"}


def heading_tape(yaw: float, width: int) -> Row:
    """Return a row of the compass around where it heads, with the figure in its middle.

    Args:
        yaw: Counter-clockwise from east, rad; what is not finite is not known.
        width: Cells.
    """
    cells, tones = [" "] * width, [Tone.MUTED] * width
    middle = width // 2
    heading = heading_from_yaw(yaw) if math.isfinite(yaw) else math.nan
    if math.isfinite(heading):
        for tick in range(0, 360, 10):
            away = (tick - heading + 180.0) % 360.0 - 180.0
            column = middle + round(away / _DEGREES)
            word = _POINTS.get(tick, f"{tick:03d}" if tick % _STEP == 0 else "╵")
            tone = Tone.STRONG if tick in _POINTS else Tone.MUTED if len(word) > 1 else Tone.FAINT
            _write(cells, tones, column - len(word) // 2, word, tone)
    figure = f"▸{round(heading) % 360:03d}°◂" if math.isfinite(heading) else f"▸ {UNKNOWN} °◂"
    _write(cells, tones, middle - len(figure) // 2 - 1, f" {figure} ", Tone.VEHICLE)
    return joined(cells, tones)


def _write(cells: list[str], tones: list[Tone], column: int, word: str, tone: Tone) -> None:
    for index, letter in enumerate(word, column):
        if 0 <= index < len(cells):
            cells[index], tones[index] = letter, tone
