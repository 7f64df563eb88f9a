"""Log: all events of the flight, the latest last, filtered by words and by how much they matter."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from textual import on
from textual.binding import Binding, BindingType
from textual.widget import Widget
from textual.widgets import Input

from groundstation.messages import Severity
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.notes import merged
from groundstation.tui.rows import Row, clock
from groundstation.tui.screens.page import Page
from groundstation.tui.theme import MARKS, TONES, Tone

# More are not kept.
_MOST = 600
_LEVELS = {Severity.INFO: "all", Severity.WARNING: "▲ ■ cautions and alarms", Severity.ALARM: "■ alarms only"}


class Log(Page):
    """The events."""

    NAME = "log"
    OWN_KEYS: ClassVar = (("/", "Filter", "screen.filter"), ("v", "Level", "screen.level"))
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("slash", "filter", "Filter", show=False),
        Binding("v", "level", "Level", show=False),
    ]

    def __init__(self) -> None:
        super().__init__()
        self._least = Severity.INFO
        self._wanted = ""

    def parts(self) -> Iterator[Widget]:
        """Yield the filter and the lines."""
        yield Input(placeholder="words to look for; Enter or Esc goes back", id="filter")
        yield Lines(self._rows, "log: all", follow=True)

    def on_mount(self) -> None:
        """Begin without a filter."""
        self.query_one("#filter").display = False

    def action_filter(self) -> None:
        """Let words be typed."""
        self.type_into(self.query_one("#filter", Input))

    def action_level(self) -> None:
        """Show less, or all again."""
        self._least = Severity((self._least + 1) % len(Severity))
        self._tell()

    def action_back(self) -> None:
        """Leave the filter first, then the page."""
        field = self.query_one("#filter", Input)
        if field.display:
            field.value = ""
            field.display = False
            self.type_no_more()
        else:
            super().action_back()

    @on(Input.Changed)
    def _take_words(self, event: Input.Changed) -> None:
        self._wanted = event.value.lower()
        self._tell()

    @on(Input.Submitted)
    def _leave_filter(self) -> None:
        self.type_no_more()

    def _tell(self) -> None:
        if self.lines is not None:
            self.lines.title = f"log: {_LEVELS[self._least]}"
            self.lines.redraw()

    def _rows(self, frame: Frame, width: int) -> list[Row]:
        del width
        rows: list[Row] = []
        for note in merged(frame.snapshot.events, frame.notes, _MOST):
            if note.severity < self._least or self._wanted not in f"{note.source} {note.text}".lower():
                continue
            tone = TONES[note.severity]
            rows.append(
                [
                    (f"{clock(note.t - frame.started)} ", Tone.MUTED),
                    (f"{MARKS[note.severity]} ", tone),
                    (f"{note.source:<10} ", Tone.MUTED),
                    (note.text, tone),
                ]
            )
        return rows or [[("Nothing yet." if not self._wanted else "Nothing with these words.", Tone.MUTED)]]
