"""A list of lines that scrolls, with or without one that is chosen; made anew from each frame, cheap to paint."""

from __future__ import annotations

from collections.abc import Callable

from textual import events
from textual.message import Message

from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, fit
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument


class Lines(Instrument):
    """Shows what `source` gives; the chosen line is marked by a sign and its ground.

    Args:
        source: Gives the lines for a frame and a width.
        title: In the border.
        chosen: One line is chosen, and moves; else the whole is scrolled.
        follow: Begin at the end, and stay there while more comes.

    Attributes:
        at: Number of the line that is chosen, or of the first that is shown.
    """

    EVERY = 5

    class Chosen(Message):
        """A line was clicked that was chosen already."""

    def __init__(
        self,
        source: Callable[[Frame, int], list[Row]],
        title: str,
        *,
        chosen: bool = False,
        follow: bool = False,
        id: str = "lines",  # noqa: A002 - Textual's own name
    ) -> None:
        super().__init__(id=id)
        self.title = self.border_title = title
        self._source, self._chosen, self._follow = source, chosen, follow
        self._count = self._top = 0
        self.at = 0

    @property
    def chooses(self) -> bool:
        """One line is chosen, and moves."""
        return self._chosen

    def move(self, by: int) -> None:
        """Move by a number of lines."""
        shown = max(self.size.height, 1)
        last = max(self._count - (1 if self._chosen else shown), 0)
        self.at = min(max(self.at + by, 0), last)
        self._follow = self._follow and self.at == last if by < 0 else self.at == last and not self._chosen
        self.redraw()

    def redraw(self) -> None:
        """Paint at once, as after a key."""
        if self._frame is not None and self.size:
            self._paint(self._frame)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the lines that there is room for, around the chosen one."""
        rows = self._source(frame, width - 2 if self._chosen else width)
        self._count = len(rows)
        if self._chosen:
            self.at = min(self.at, max(self._count - 1, 0))
            self._top = min(max(self._top, self.at - height + 1), self.at)
        else:
            last = max(self._count - height, 0)
            self._top = self.at = last if self._follow else min(self.at, last)
        self._tell_place(height)
        shown = rows[self._top : self._top + height]
        if not self._chosen:
            return shown
        return [
            self._marked(row, width, chosen=self._top + index == self.at) for index, row in enumerate(shown)
        ]

    def footnote(self, frame: Frame) -> str:
        """Say which of how many lines are shown, where not all are."""
        del frame
        return self._place

    _place = ""

    def _tell_place(self, height: int) -> None:
        more = self._count > height
        last = min(self._top + height, self._count)
        self._place = f"{self._top + 1}–{last} of {self._count}" if more else ""

    def _marked(self, row: Row, width: int, *, chosen: bool) -> Row:
        if not chosen:
            return [("  ", Tone.TEXT), *row]
        return fit(
            [("▸ ", Tone.KEY), *[(text, Tone.CHIP) for text, _ in row], (" " * width, Tone.CHIP)], width
        )

    def on_click(self, event: events.Click) -> None:
        """Choose the line under the pointer; once more, and it is taken."""
        if self._chosen and (line := self._top + event.y - 1) < self._count:
            if line == self.at:
                self.post_message(self.Chosen())
            self.move(line - self.at)

    def on_mouse_scroll_down(self) -> None:
        """Scroll."""
        self.move(3)

    def on_mouse_scroll_up(self) -> None:
        """Scroll."""
        self.move(-3)
