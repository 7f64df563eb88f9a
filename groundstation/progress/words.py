"""Progress in words and signs, the same in tables, on the screen and on paper."""

from __future__ import annotations

import datetime
from collections.abc import Sequence

from groundstation.progress.skills import Record

_BARS = "▁▂▃▄▅▆▇█"
PASSED, NEXT, OPEN, LOCKED = "✓", "▸", " ", "·"


def trend(points: Sequence[float], most: int = 8) -> str:
    """Draw the last points, 0 to 100, one sign each."""
    last = len(_BARS) - 1
    return "".join(_BARS[min(max(round(each / 100.0 * last), 0), last)] for each in points[-most:])


def mark(record: Record, following: str | None) -> str:
    """Return the sign of a mission's state; `following` is the name of the one that comes next."""
    if record.mission.name == following:
        return NEXT
    if record.passed is not None:
        return PASSED
    return OPEN if record.open else LOCKED


def due_words(record: Record, today: datetime.date) -> str:
    """Say when a mission is to be repeated, or why it cannot be flown yet; "" for neither."""
    if record.repetition:
        days = (record.repetition.due - today).days
        return "due" if days <= 0 else "tomorrow" if days == 1 else f"in {days} days"
    if record.open:
        return ""
    first, *others = record.missing
    return f"needs {first}{f' and {len(others)} more' if others else ''}"


def number(points: float | None) -> str:
    """Write points; a dash for none."""
    return "–" if points is None else f"{points:.0f}"


def hours(seconds: float) -> str:
    """Write time in the air."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def counted(count: int, thing: str) -> str:
    """Write a number of things."""
    return f"{count} {thing}{'' if count == 1 else 's'}"
