"""Parameters: the vehicle's own, searched, and set on the ground after asking back."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar

from textual import on
from textual.binding import Binding, BindingType
from textual.widget import Widget
from textual.widgets import Input

from groundstation.messages import CommandKind, Parameter, Severity
from groundstation.tui.acts import armed, in_air
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.rows import Row, span_of_time
from groundstation.tui.screens.dialog import Typed
from groundstation.tui.screens.page import Page
from groundstation.tui.theme import MARKS, Tone
from groundstation.vehicle.profiles import PROFILES

_JUDGES = {each.name: each.judge for profile in PROFILES.values() for each in profile.judged}
_TONES = {Severity.INFO: Tone.MUTED, Severity.WARNING: Tone.WARN, Severity.ALARM: Tone.FAULT}


class ParametersPage(Page):
    """The vehicle's parameters."""

    NAME = "parameters"
    OWN_KEYS: ClassVar = (
        ("/", "Search", "screen.search"),
        ("Enter", "Set", "screen.set"),
        ("u", "Read all", "screen.read"),
    )
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("slash", "search", "Search", show=False),
        Binding("enter", "set", "Set", show=False),
        Binding("u,U", "read", "Read all", show=False),
    ]

    def __init__(self) -> None:
        super().__init__()
        self._wanted = ""
        self._shown: list[Parameter] = []

    def parts(self) -> Iterator[Widget]:
        """Yield the search field and the list."""
        yield Input(placeholder="part of a name; Enter goes to the list, Esc ends the search", id="filter")
        yield Lines(self._rows, "parameters of the vehicle", chosen=True)

    def on_mount(self) -> None:
        """Begin without a search; read what has not been read."""
        self.query_one("#filter").display = False
        if not any(parameter.count for parameter in self.flight.snapshot.parameters.values()):
            self.action_read()

    def action_read(self) -> None:
        """Read all of them from the vehicle."""
        self.flight.send(CommandKind.PARAMETERS)

    def action_search(self) -> None:
        """Let a part of a name be typed."""
        self.type_into(self.query_one("#filter", Input))

    def action_back(self) -> None:
        """End the search first, then leave."""
        field = self.query_one("#filter", Input)
        if field.display:
            field.value = ""
            field.display = False
            self.type_no_more()
        else:
            super().action_back()

    @on(Input.Changed, "#filter")
    def _take_words(self, event: Input.Changed) -> None:
        self._wanted = event.value.upper()
        if self.lines is not None:
            self.lines.at = 0
            self.lines.redraw()

    @on(Input.Submitted, "#filter")
    def _to_the_list(self) -> None:
        self.type_no_more()

    @on(Lines.Chosen)
    def action_set(self) -> None:
        """Ask for a value, on the ground only."""
        snapshot = self.flight.snapshot
        if in_air(snapshot) or armed(snapshot):
            words = "Parameters are set on the ground, disarmed; this vehicle is not."
            self.notify(words, severity="warning", timeout=4.0)
        elif self.lines is not None and self.lines.at < len(self._shown):
            self._ask(self._shown[self.lines.at])

    def _ask(self, parameter: Parameter) -> None:
        name, now = parameter.name.decode(), written(parameter)
        which = "the simulated" if self.flight.simulated else "the REAL"
        question = f"Set {name} of {which} vehicle?"

        def typed(text: str | None) -> None:
            if text is not None:
                words = f"from {now} to {text}"
                self.flight.ask(question, words, lambda: self._set(name, float(text)))

        self.app.push_screen(
            Typed(f"{name} is {now}", "What shall it be?", lambda text: _wrong(parameter, text), now), typed
        )

    def _set(self, name: str, amount: float) -> None:
        self.flight.send(CommandKind.SET_PARAMETER, name=name, amount=amount)

    def _rows(self, frame: Frame, width: int) -> list[Row]:
        read = frame.snapshot.parameters
        self._shown = [read[name] for name in sorted(read) if self._wanted in name]
        if not read:
            return [[("None read yet. u reads them from the vehicle.", Tone.MUTED)]]
        if not self._shown:
            return [[(f"No name has {self._wanted!r} in it.", Tone.MUTED)]]
        return [_row(parameter, frame.now, width) for parameter in self._shown]


def written(parameter: Parameter) -> str:
    """Write a value as people would: whole numbers whole, others as short as they are exact."""
    return f"{parameter.value:.0f}" if parameter.whole else f"{parameter.value:.6g}"


def _wrong(parameter: Parameter, text: str) -> str:
    """Say why a text is no value for a parameter, or ""."""
    try:
        value = float(text)
    except ValueError:
        return f"{text!r} is not a number"
    if not math.isfinite(value):
        return "it must be a finite number"
    return "this one takes whole numbers" if parameter.whole and value != int(value) else ""


def _row(parameter: Parameter, now: float, width: int) -> Row:
    name = parameter.name.decode()
    row: Row = [(f"{name:<17}", Tone.STRONG), (f"{written(parameter):>12}", Tone.TEXT)]
    judge = _JUDGES.get(name)
    if judge is not None:
        judged = judge(parameter.value)
        row.append((f"  {MARKS[judged.severity]} {judged.means}", _TONES[judged.severity]))
    elif width > 60:
        row.append((f"  read {span_of_time(now - parameter.t)} ago", Tone.FAINT))
    return row
