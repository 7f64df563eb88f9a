"""Settings: all of them, changed by the settings' own rules, saved into the file, live where the pilot takes them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from textual import on
from textual.binding import Binding, BindingType
from textual.widget import Widget

from groundstation.errors import InputError
from groundstation.tui.acts import coupled
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.rows import Row
from groundstation.tui.screens.dialog import Typed
from groundstation.tui.screens.page import Page
from groundstation.tui.setting_list import Entry, changed, entries
from groundstation.tui.theme import Tone

_KEY = 28
_VALUE = 24
_NOTE = 22
# From here on what a setting is stands beside it.
_WIDE = 100


class SettingsPage(Page):
    """The program's settings."""

    NAME = "settings"
    OWN_KEYS: ClassVar = (("Enter", "Change", "screen.change"),)
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "change", "Change", show=False)]

    def __init__(self) -> None:
        super().__init__()
        self._shown: list[Entry] = []

    def parts(self) -> Iterator[Widget]:
        """Yield the list."""
        yield Lines(self._rows, f"settings: saved in {self.flight.settings_file}", chosen=True)

    @on(Lines.Chosen)
    def action_change(self) -> None:
        """Ask for a value."""
        if self.lines is not None and self.lines.at < len(self._shown):
            entry = self._shown[self.lines.at]
            if entry.live and coupled(self.flight.snapshot):
                self.notify("Release the hand first: this one changes how it flies.", severity="warning")
            else:
                self._ask(entry)

    def _ask(self, entry: Entry) -> None:
        def wrong(text: str) -> str:
            try:
                changed(self.flight.settings, entry.section, entry.key, text)
            except InputError as error:
                return str(error)
            return ""

        def typed(text: str | None) -> None:
            if text is not None:
                self.flight.set_setting(entry, text)

        name = f"{entry.section}.{entry.key}"
        when = "It takes effect at once." if entry.live else "It takes effect at the next start."
        words = f"{entry.explains}\n{when}" if entry.explains else when
        self.app.push_screen(Typed(f"{name} is {entry.value}", words, wrong, entry.value), typed)

    def _rows(self, frame: Frame, width: int) -> list[Row]:
        del frame
        self._shown = entries(self.flight.settings)
        return [_row(entry, width) for entry in self._shown]


def _row(entry: Entry, width: int) -> Row:
    note = f"{'default' if entry.usual else 'changed'}{'' if entry.live else ', at next start'}"
    row: Row = [
        (f"{entry.section + '.' + entry.key:<{_KEY}} ", Tone.MUTED),
        (f"{entry.value:<{_VALUE}} ", Tone.TEXT if entry.usual else Tone.STRONG),
        (
            f"{note:<{_NOTE}} ",
            Tone.FAINT if entry.usual and entry.live else Tone.WARN if not entry.usual else Tone.MUTED,
        ),
    ]
    return [*row, (entry.explains, Tone.MUTED)] if width > _WIDE else row
