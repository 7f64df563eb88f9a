"""Dialogs over the flight: they stand over the events, hide no essentials, and let urgent acts through."""

from __future__ import annotations

from typing import ClassVar

from rich.table import Table
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from groundstation.messages import CommandKind
from groundstation.tui.acts import ACTS, BY_NAME
from groundstation.tui.choices import CHOICES, CUES
from groundstation.tui.screens.flight import STEPS
from groundstation.tui.theme import STYLES, Tone


def _urgent() -> list[BindingType]:
    return [
        Binding(",".join(act.keys), f"urgent('{act.name}')", act.label, show=False)
        for act in ACTS
        if act.urgent
    ]


class Dialog(ModalScreen[bool]):
    """What all dialogs share: Escape leaves, an urgent act leaves and is done."""

    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "answer(False)", "Back", show=False),
        *_urgent(),
    ]

    def action_answer(self, yes: bool) -> None:
        """Leave with an answer."""
        self.dismiss(yes)

    async def action_urgent(self, name: str) -> None:
        """Leave, and do what cannot wait."""
        self.dismiss(result=False)
        await self.app.run_action(f"app.act('{name}')")


class Confirm(Dialog):
    """Asks back before an act.

    Args:
        question: What is asked.
        consequence: What happens then.
        key: The key that says yes, besides y.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("y,Y", "answer(True)", "Yes", show=False),
        Binding("n,N", "answer(False)", "No", show=False),
    ]

    def __init__(self, question: str, consequence: str, key: str = "y") -> None:
        super().__init__()
        self._question, self._consequence, self._key = question, consequence, key
        self._bindings.bind(key, "answer(True)", "Yes", show=False)

    async def action_urgent(self, name: str) -> None:
        """Take the act that is asked about as a yes; others are done at once."""
        if BY_NAME[name].key == self._key:
            self.dismiss(result=True)
        else:
            await super().action_urgent(name)

    def compose(self) -> ComposeResult:
        """Lay out question, consequence and keys."""
        with Vertical(id="dialog"):
            yield Static(f"▲ {self._question}", id="question", markup=False)
            yield Static(self._consequence, id="consequence", markup=False)
            yes = "y" if self._key == "y" else f"{self._key} again or y"
            yield Static(f"{yes}  yes      n or Esc  no", id="answers", markup=False)


class Help(Dialog):
    """All keys, from the tables that bind them."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("question_mark,f1,q", "answer(False)", "Back", show=False),
    ]

    def compose(self) -> ComposeResult:
        """Lay out the keys."""
        with VerticalScroll(id="help"):
            yield Static(help_table())


def help_table() -> Table:
    """Return the keys as a table of key, name and what it does."""
    table = Table.grid(padding=(0, 1))
    table.add_column(justify="right", style=STYLES[Tone.KEY], no_wrap=True)
    table.add_column(style=STYLES[Tone.TEXT], no_wrap=True)
    table.add_column(style=STYLES[Tone.MUTED])
    for act in ACTS:
        table.add_row(act.key, act.label, act.explains)
    _section(table, "choices", "at any time")
    for choice in CHOICES:
        if choice.kind is not CommandKind.CUES:
            table.add_row(choice.key, choice.label, choice.explains)
    _section(table, "cues", "parts of the force; on, or off again")
    for choice in CUES.values():
        table.add_row(choice.key, choice.name, choice.explains)
    _section(table, "stick", "on the screen; steps of 20 % that stay")
    arrows = {"up": "↑", "down": "↓", "left": "←", "right": "→"}
    for key, _, _, words in STEPS:
        table.add_row(arrows.get(key, key), words)
    table.add_row("space", "centre", "All axes at once; also 0.")
    table.add_row("mouse", "drag", "Press in a pad and drag; letting go centres, in rate mode.")
    _section(table, "screen", "")
    table.add_row("?", "help", "Esc goes back.")
    table.add_row("^p", "palette", "All acts by name.")
    table.add_row("q", "quit", "Asks first in the air; the vehicle holds.")
    _section(table, "signs", "")
    table.add_row("▲ ■", "severity", "Caution, alarm.")
    table.add_row(Text("abc", STYLES[Tone.STALE]), "slanted", "Old: do not trust it.")
    table.add_row(
        Text("□", STYLES[Tone.HAND]), "p_h", "Where the hand wants the vehicle; around it the leash."
    )
    table.add_row(Text("△ ×", STYLES[Tone.VEHICLE]), "forecast", "Where it will be; where it can stop.")
    table.add_row(Text("POS", STYLES[Tone.FORCE]), "cue", "In capitals: acts. ○ off, – not in this preset.")
    table.add_row("↓", "gain", "The delay leaves less than is set.")
    table.add_row(Text("◎", STYLES[Tone.TARGET]), "target", "Where the mission leads.")
    table.add_row("+ −", "axes", "Positive is forward, left, up, turning left.")
    return table


def _section(table: Table, title: str, words: str) -> None:
    table.add_row("", "", "")
    table.add_row("", Text(title, STYLES[Tone.STRONG]), words)
