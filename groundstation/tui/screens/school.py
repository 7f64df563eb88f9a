"""School: how the pilot stands, and on the ground the way into another mission."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from textual import on
from textual.widget import Widget

from groundstation.tui.school_view import SchoolView
from groundstation.tui.screens.page import Page


class SchoolPage(Page):
    """The course beside a flight."""

    NAME = "school"
    HORIZONTAL_BREAKPOINTS = [(0, "-stacked"), (140, "-beside")]  # noqa: RUF012 - Textual's
    OWN_KEYS: ClassVar = (
        ("Enter", "Fly it", "screen.take"),
        ("p", "Next pilot", "screen.next_pilot"),
        ("a", "Another pilot", "screen.new_pilot"),
    )

    def parts(self) -> Iterator[Widget]:
        """Yield the course."""
        yield SchoolView(self.flight.desk, self.flight.pilot)

    @on(SchoolView.Chosen)
    def fly(self, message: SchoolView.Chosen) -> None:
        """Have a mission flown, if the vehicle is one for it."""
        self.flight.fly_next(message.wish)

    def action_take(self) -> None:
        """Fly what is chosen."""
        self.query_one(SchoolView).take()

    def action_next_pilot(self) -> None:
        """Show another pilot."""
        self.query_one(SchoolView).action_next_pilot()

    def action_new_pilot(self) -> None:
        """Have a name typed."""
        self.query_one(SchoolView).action_new_pilot()
