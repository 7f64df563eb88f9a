"""Preflight: every check with its state and, where it is not well, what to do; and the device's buttons."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget

from groundstation.messages import Severity
from groundstation.tui.buttons import button_map, held, unmapped
from groundstation.tui.checks import checks
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.rows import Row
from groundstation.tui.screens.page import Page
from groundstation.tui.theme import Tone

_MARKS = {
    Severity.INFO: ("✓", Tone.OK),
    Severity.WARNING: ("▲", Tone.WARN),
    Severity.ALARM: ("■", Tone.FAULT),
}
_NAME = 20
# From here on the remedy stands beside the state.
_WIDE = 110


class Preflight(Page):
    """The checks."""

    NAME = "preflight"
    OWN_KEYS: ClassVar = (("e", "Engage", "screen.letter('e', 'engage')"),)
    BINDINGS: ClassVar[list[BindingType]] = [Binding("e,E", "letter('e', 'engage')", "Engage", show=False)]

    def parts(self) -> Iterator[Widget]:
        """Yield the list of checks."""
        yield Lines(_rows, "preflight")


def _rows(frame: Frame, width: int) -> list[Row]:
    found = checks(frame)
    rows: list[Row] = [_total([check.severity for check in found]), []]
    for check in found:
        mark, tone = _MARKS[check.severity]
        row: Row = [
            (f"{mark} ", tone),
            (check.name.ljust(_NAME), Tone.STRONG),
            (f" {check.state}", Tone.TEXT),
        ]
        if check.remedy and width >= _WIDE:
            row.append((f"  → {check.remedy}", Tone.WARN))
        rows.append(row)
        if check.remedy and width < _WIDE:
            rows.append([(" " * (_NAME + 3), Tone.TEXT), (f"→ {check.remedy}", Tone.WARN)])
    return [*rows, [], *_buttons(frame)]


def _total(severities: list[Severity]) -> Row:
    red, yellow = severities.count(Severity.ALARM), severities.count(Severity.WARNING)
    if red:
        return [
            (f"■ {red} to mend before the hand may be coupled", Tone.FAULT),
            (_cautions(yellow), Tone.WARN),
        ]
    if yellow:
        return [("✓ may be flown", Tone.OK), (_cautions(yellow), Tone.WARN)]
    return [("✓ all is well", Tone.OK)]


def _cautions(number: int) -> str:
    return f"   ▲ {number} to know of" if number else ""


def _buttons(frame: Frame) -> Iterator[Row]:
    """Yield the map of the device's buttons; those that are held now stand out."""
    buttons = frame.run.settings.buttons
    pressed = held(frame.snapshot.handle)
    yield [("buttons of the device, from 0", Tone.MUTED)]
    for number, words in button_map(buttons):
        tone = Tone.CHIP_HAND if number in pressed else Tone.KEY
        now = "  ◀ held" if number in pressed else ""
        yield [(f"  {number:2d} ", tone), (f" {words}{now}", Tone.TEXT)]
    if free := unmapped(buttons):
        yield [(f"     without a button: {', '.join(free)}", Tone.MUTED)]
