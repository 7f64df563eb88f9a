"""Rows of text in tones, and numbers written with their units: what all instruments are made of."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence

from groundstation.tui.theme import Tone

Span = tuple[str, Tone]
Row = list[Span]

UNKNOWN = "–"


def quantity(value: float | None, unit: str, decimals: int = 2, width: int = 0, *, sign: bool = False) -> str:
    """Write a number with its unit; what is not known is a dash.

    Args:
        value: None and what is not finite are not known.
        unit: As shown after the number.
        decimals: Digits after the point; fewer where the number would not fit `width`.
        width: Of the number, to which it is aligned right.
        sign: Write a plus, too.
    """
    if value is None or not math.isfinite(value):
        return f"{UNKNOWN.rjust(width)} {unit}"
    form = "+" if sign else ""
    text = f"{value:{form}.{decimals}f}"
    while width and len(text) > width and decimals > 0:
        decimals -= 1
        text = f"{value:{form}.{decimals}f}"
    if not float(text):
        text = text.replace("-", "+" if sign else "")
    return f"{text.replace('-', '−').rjust(width)} {unit}"


def span_of_time(seconds: float) -> str:
    """Write a duration the way one says it: 0.02 s, 3.4 s, 42 s, 3 min."""
    if not math.isfinite(seconds):
        return f"{UNKNOWN} s"
    if seconds < 1.0:
        return f"{max(seconds, 0.0):.2f} s"
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


def clock(seconds: float) -> str:
    """Write a time since the start as minutes and seconds."""
    minutes, rest = divmod(max(int(seconds), 0), 60)
    return f"{minutes:02d}:{rest:02d}"


def width_of(row: Iterable[Span]) -> int:
    """Return the cells a row takes; all our characters take one."""
    return sum(len(text) for text, _ in row)


def fit(row: Row, width: int) -> Row:
    """Return the row cut or filled to a width."""
    left = width
    fitted: Row = []
    for text, tone in row:
        if left <= 0:
            break
        fitted.append((text[:left], tone))
        left -= len(text)
    if left > 0:
        fitted.append((" " * left, Tone.TEXT))
    return fitted


def spread(left: Row, right: Row, width: int, ground: Tone = Tone.TEXT) -> Row:
    """Return a row with one part at each end; the right one is cut where there is no room."""
    gap = max(width - width_of(left) - width_of(right), 1)
    return fit([*left, (" " * gap, ground), *right], width)


def columns_of(row: Row) -> list[tuple[int, Span]]:
    """Return the spans of a row, each with the column in which it begins."""
    starts = itertools.accumulate((len(text) for text, _ in row), initial=0)
    return list(zip(starts, row, strict=False))


def joined(cells: Sequence[str], tones: Sequence[Tone]) -> Row:
    """Return cells of one character each as a row of runs of equal tone."""
    row: Row = []
    start = 0
    for index in range(1, len(cells) + 1):
        if index == len(cells) or tones[index] != tones[start]:
            row.append(("".join(cells[start:index]), tones[start]))
            start = index
    return row


def wrapped(text: str, width: int) -> list[str]:
    """Break a sentence between words; textwrap is several times slower, and this runs in every frame."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}" if lines[-1] else word
    return lines


def shortened(words: str, width: int) -> str:
    """Return as many whole words as there is room for, with … where some are left out."""
    if len(words) <= width:
        return words
    kept = f"{wrapped(words, max(width - 2, 0))[0]} …"
    return kept if len(kept) <= width else f"{words[: max(width - 1, 0)]}…"[: max(width, 0)]


def bar(value: float | None, limit: float, width: int, tone: Tone, mark: float | None = None) -> Row:
    """Return a signed bar from the middle, half a cell fine, with a mark for a second value.

    Args:
        value: Positive to the right; None and what is not finite draw the empty track.
        limit: At full deflection, where the bar turns into a warning.
        width: Cells.
        tone: Of the bar.
        mark: Another value on the same scale, drawn as a line.
    """
    half = (width - 1) // 2
    cells, tones = ["─"] * (2 * half + 1), [Tone.GRID] * (2 * half + 1)
    if value is not None and math.isfinite(value) and limit > 0:
        share = min(abs(value) / limit, 1.0)
        steps = round(share * half * 2)
        side = 1 if value > 0 else -1
        full = Tone.WARN if share >= 1.0 else tone
        for cell in range(1, (steps + 1) // 2 + 1):
            whole = steps >= 2 * cell
            cells[half + side * cell] = "█" if whole else "▌" if side > 0 else "▐"
            tones[half + side * cell] = full
    cells[half], tones[half] = "┼", Tone.MUTED
    if mark is not None and math.isfinite(mark) and limit > 0:
        place = half + round(max(-1.0, min(1.0, mark / limit)) * half)
        cells[place], tones[place] = "┃", Tone.HAND
    return joined(cells, tones)


def gauge(value: float | None, limit: float, width: int, tone: Tone, full: Tone = Tone.WARN) -> Row:
    """Return a bar from the left for what has no sign, half a cell fine; what is not known is an empty track.

    Args:
        value: From 0 on.
        limit: At full deflection.
        width: Cells.
        tone: Of the bar.
        full: Of the bar at full deflection: a warning, where that is nothing good.
    """
    width = max(width, 0)
    known = value is not None and math.isfinite(value) and limit > 0
    share = max(0.0, min(value / limit, 1.0)) if known and value is not None else 0.0
    whole, half = divmod(round(2 * share * width), 2)
    filled = "█" * whole + "▌" * half
    return [(filled, full if share >= 1.0 else tone), ("─" * (width - whole - half), Tone.GRID)]
