"""The line of instruments, each of which can have the whole body: the one that has it stands out; a click chooses."""

from __future__ import annotations

from collections.abc import Callable

from textual import events

from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

ALL = "all"
NAMES = (
    ALL,
    "map",
    "attitude",
    "stick",
    "force",
    "tracking",
    "velocity",
    "curves",
    "mission",
    "system",
    "events",
)

_HEAD = " ⇥ "


class Pages(Instrument):
    """One line.

    Args:
        choose: Called with the name that was clicked on.

    Attributes:
        page: The instrument that has the body, or all that there is room for.
    """

    EVERY = 3

    def __init__(self, choose: Callable[[str], None], *, id: str | None = None) -> None:  # noqa: A002 - Textual's
        super().__init__(id=id)
        self._choose = choose
        self.page = ALL

    def after(self, steps: int) -> str:
        """Return the page so many steps further on."""
        return NAMES[(NAMES.index(self.page) + steps) % len(NAMES)]

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the names after the key that goes on."""
        del frame, width, height
        row: Row = [(_HEAD, Tone.KEY)]
        for name in NAMES:
            here = name == self.page
            row += [
                (name.upper() if here else name, Tone.CHIP_HAND if here else Tone.MUTED),
                (" ", Tone.TEXT),
            ]
        return [row]

    def on_click(self, event: events.Click) -> None:
        """Choose the instrument under the pointer."""
        start = len(_HEAD)
        for name in NAMES:
            end = start + len(name) + 1
            if start <= event.x < end:
                self._choose(name)
                return
            start = end
