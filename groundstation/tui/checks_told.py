"""What the checks before a flight come to, in words: on the page, on paper, in the recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from groundstation.messages import Severity
from groundstation.tui.check import Check

MARKS = {Severity.INFO: "✓", Severity.WARNING: "▲", Severity.ALARM: "■"}
LEVELS = {Severity.INFO: "ok", Severity.WARNING: "caution", Severity.ALARM: "danger"}
NAME_WIDTH = 23


def counted(found: Sequence[Check]) -> tuple[int, int]:
    """Return how many checks are red, and how many are to be known of."""
    severities = [check.severity for check in found]
    return severities.count(Severity.ALARM), severities.count(Severity.WARNING)


def verdict(red: int, yellow: int) -> str:
    """Return what so many that are red, and so many to know of, come to."""
    if red:
        return f"■ {red} to mend before the flight"
    return "✓ may be flown" if yellow else "✓ all is well"


def cautions(yellow: int) -> str:
    """Return how many there are to know of, or ""."""
    return f"▲ {yellow} to know of" if yellow else ""


def total(found: Sequence[Check]) -> str:
    """Return what the checks come to in a line."""
    red, yellow = counted(found)
    return "   ".join(filter(None, (verdict(red, yellow), cautions(yellow))))


def in_words(found: Sequence[Check], heading: str) -> str:
    """Return the checks as text to print."""
    return "\n".join((heading, total(found), "", *_lines(found)))


def _lines(found: Sequence[Check]) -> Iterator[str]:
    for check in found:
        yield f"{MARKS[check.severity]} {check.name.ljust(NAME_WIDTH)} {check.state}"
        if check.remedy:
            yield f"{' ' * (NAME_WIDTH + 2)} → {check.remedy}"
