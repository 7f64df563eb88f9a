"""Preflight: every check with its state and, where it is not well, what to do; and the device's buttons."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget

from groundstation.messages import Severity
from groundstation.tui.buttons import button_map, held, unmapped
from groundstation.tui.check import Check
from groundstation.tui.checks import checks
from groundstation.tui.checks_told import MARKS, NAME_WIDTH, cautions, counted, verdict
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.rows import Row, wrapped
from groundstation.tui.screens.page import Page
from groundstation.tui.theme import Tone

_TONES = {Severity.INFO: Tone.OK, Severity.WARNING: Tone.WARN, Severity.ALARM: Tone.FAULT}
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
    rows: list[Row] = [_total(found), []]
    for check in found:
        rows += _told(check, width)
    return [*rows, [], *_buttons(frame)]


def _told(check: Check, width: int) -> Iterator[Row]:
    """Yield a check's rows: on a wide screen one, else the remedy below the state, and none is cut."""
    head: Row = [
        (f"{MARKS[check.severity]} ", _TONES[check.severity]),
        (check.name.ljust(NAME_WIDTH), Tone.STRONG),
    ]
    if width >= _WIDE:
        remedy: Row = [(f"  → {check.remedy}", Tone.WARN)] if check.remedy else []
        yield [*head, (f" {check.state}", Tone.TEXT), *remedy]
        return
    blank: Row = [(" " * (NAME_WIDTH + 2), Tone.TEXT)]
    room = width - NAME_WIDTH - 3
    for number, line in enumerate(wrapped(check.state, room)):
        yield [*(blank if number else head), (f" {line}", Tone.TEXT)]
    for line in wrapped(f"→ {check.remedy}", room) if check.remedy else ():
        yield [*blank, (f" {line}", Tone.WARN)]


def _total(found: list[Check]) -> Row:
    red, yellow = counted(found)
    row: Row = [(verdict(red, yellow), Tone.FAULT if red else Tone.OK)]
    return [*row, (f"   {cautions(yellow)}", Tone.WARN)] if yellow else row


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
