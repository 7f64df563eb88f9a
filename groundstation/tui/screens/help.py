"""Help: all keys, from the tables that bind them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

from rich.style import Style
from rich.table import Table
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.widgets import Static

from groundstation.config import Buttons
from groundstation.messages import CommandKind
from groundstation.tui.acts import ACTS, URGENT
from groundstation.tui.buttons import button_map
from groundstation.tui.choices import CHOICES, CUES
from groundstation.tui.everywhere import KEYS
from groundstation.tui.pages import PAGES
from groundstation.tui.screens.dialog import Dialog
from groundstation.tui.screens.flight import STEPS, FlightScreen
from groundstation.tui.theme import Tone, styles_of

# Bindings that come from tables of their own, or are explained in words.
_TABLED = ("app.act", "app.choose", "app.help", "app.quit", "step", "centre")
_WRITTEN = {"plus": "+", "minus": "−", "shift+tab": "⇧Tab", "tab": "Tab", "enter": "Enter", "ctrl+t": "^t"}


class Help(Dialog):
    """All keys and buttons.

    Args:
        buttons: What the device's buttons do.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("question_mark,f1,q", "answer(False)", "Back", show=False),
    ]

    def __init__(self, buttons: Buttons) -> None:
        super().__init__()
        self._buttons = buttons

    def compose(self) -> ComposeResult:
        """Lay out the keys."""
        with VerticalScroll(id="help"):
            yield Static(help_table(self._buttons, styles_of(self.app.theme)))


def help_table(buttons: Buttons, styles: Mapping[Tone, Style]) -> Table:
    """Return the keys as a table of key, name and what it does, in the styles of a theme."""

    def heading(words: str) -> Text:
        return Text(words, styles[Tone.STRONG])

    table = Table.grid(padding=(0, 1))
    table.add_column(justify="right", style=styles[Tone.KEY], no_wrap=True)
    table.add_column(style=styles[Tone.TEXT], no_wrap=True)
    table.add_column(style=styles[Tone.MUTED])
    for act in ACTS:
        table.add_row(f"{act.key} {act.everywhere.upper()}".strip(), act.label, act.explains)
    table.add_row(
        "", "", f"{URGENT[0].everywhere.upper()} to {URGENT[-1].everywhere.upper()} work over dialogs, too."
    )
    _section(table, heading("screens"), "Esc or the same key goes back to the flight")
    for page in PAGES:
        table.add_row(page.shown, page.label, page.explains)
    _section(table, heading("choices"), "at any time")
    for choice in CHOICES:
        if choice.kind is not CommandKind.CUES:
            table.add_row(choice.key, choice.label, choice.explains)
    _section(table, heading("cues"), "parts of the force; on, or off again")
    for choice in CUES.values():
        table.add_row(choice.key, choice.name, choice.explains)
    _section(table, heading("stick"), "on the screen; steps of 20 % that stay")
    arrows = {"up": "↑", "down": "↓", "left": "←", "right": "→"}
    for key, _, _, words in STEPS:
        table.add_row(arrows.get(key, key), words)
    table.add_row("space", "centre", "All axes at once; also 0.")
    table.add_row("mouse", "drag", "Press in a pad and drag; letting go centres, in rate mode.")
    _section(table, heading("buttons"), "of the haptic device, from 0")
    for number, words in button_map(buttons):
        table.add_row(str(number), "button", words[0].upper() + words[1:] + ".")
    _section(table, heading("screen"), "")
    table.add_row("? F1", "help", "Esc goes back.")
    for key, words in _other_keys():
        table.add_row(key, words, "")
    table.add_row("^p", "palette", "All acts by name.")
    table.add_row("q", "quit", "Asks first in the air; the vehicle holds.")
    _section(table, heading("signs"), "")
    table.add_row("▲ ■", "severity", "Caution, alarm.")
    table.add_row(Text("abc", styles[Tone.STALE]), "slanted", "Old: do not trust it.")
    table.add_row(
        Text("□", styles[Tone.HAND]), "p_h", "Where the hand wants the vehicle; around it the leash."
    )
    table.add_row(Text("△ ×", styles[Tone.VEHICLE]), "forecast", "Where it will be; where it can stop.")
    table.add_row(Text("POS", styles[Tone.FORCE]), "cue", "In capitals: acts. ○ off, – not in this preset.")
    table.add_row("↓", "gain", "The delay leaves less than is set.")
    table.add_row(Text("◎", styles[Tone.TARGET]), "target", "Where the mission leads.")
    table.add_row("+ −", "axes", "Positive is forward, left, up, turning left.")
    return table


def _other_keys() -> Iterator[tuple[str, str]]:
    """Yield the keys of the flight screen that no table has, with what they do."""
    for binding in (*KEYS, *FlightScreen.BINDINGS):
        assert isinstance(binding, Binding)
        if not binding.action.startswith(_TABLED):
            key = binding.key.partition(",")[0]
            yield _WRITTEN.get(key, key), binding.description


def _section(table: Table, title: Text, words: str) -> None:
    table.add_row("", "", "")
    table.add_row("", title, words)
