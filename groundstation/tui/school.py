"""The school before a flight: who flies, how they stand, and which mission it shall be."""

from __future__ import annotations

from typing import ClassVar

from rich.text import Text
from textual import on
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Static

from groundstation.progress.desk import Desk
from groundstation.tui.school_view import SchoolView, keys_line
from groundstation.tui.theme import THEME, THEMES, Tone, next_theme, styles_of
from groundstation.tui.wish import Wish

_KEYS = (
    ("↑↓", "choose"),
    ("Enter", "fly it"),
    ("p", "next pilot"),
    ("a", "another pilot"),
    ("^t", "theme"),
    ("q", "leave"),
)


class School(App[Wish]):
    """Ends with what shall be flown by whom, or with None.

    Args:
        desk: Knows the pilots.
        pilot: Who is shown first.
    """

    TITLE = "groundstation"
    ENABLE_COMMAND_PALETTE = False
    CSS = """
    Screen { background: $ink; color: $text; }
    #title, #keys { height: 1; background: $pane; padding: 0 1; }
    Typed { background: transparent; align: left bottom; }
    #dialog { width: 64; height: auto; margin: 0 0 1 0; padding: 0 1; background: $pane; border: heavy $warn; }
    #question { color: $warn; text-style: bold; }
    #answers { color: $muted; }
    #typed { height: 3; border: round $vehicle; background: $ink; }
    """
    HORIZONTAL_BREAKPOINTS = [(0, "-stacked"), (140, "-beside")]  # noqa: RUF012 - Textual's
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+t", "next_theme", "Next theme", show=False),
        Binding("q,escape", "leave", "Leave", show=False),
        Binding("ctrl+c,ctrl+q", "leave", "Leave", show=False, priority=True),
    ]

    def __init__(self, desk: Desk, pilot: str) -> None:
        super().__init__()
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = THEME.name
        self._desk, self._pilot = desk, pilot

    def compose(self) -> ComposeResult:
        """Lay out the course between title and keys."""
        yield Static(id="title")
        yield SchoolView(self._desk, self._pilot)
        yield Static(id="keys")

    def on_mount(self) -> None:
        """Write title and keys, in each theme anew."""
        self.watch(self, "theme", self._write)

    def _write(self) -> None:
        title = Text("groundstation   the school: learn to fly by feel", styles_of(self.theme)[Tone.STRONG])
        self.query_one("#title", Static).update(title)
        self.query_one("#keys", Static).update(keys_line(self.theme, _KEYS))

    @on(SchoolView.Chosen)
    def fly(self, message: SchoolView.Chosen) -> None:
        """End with what shall be flown."""
        self.exit(message.wish)

    def action_next_theme(self) -> None:
        """Change to the next theme: dark, light, high contrast."""
        self.theme = next_theme(self.theme)

    def action_leave(self) -> None:
        """Fly nothing."""
        self.exit(None)
