"""What all instruments share: rows drawn from a frame, of which only those that changed are painted."""

from __future__ import annotations

import math
from typing import ClassVar, Self

from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget

from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, fit, span_of_time
from groundstation.tui.theme import Tone, styles_of

_STALE_CLASS = "-stale"
# Younger than this is simply fresh, s.
_FRESH_S = 0.1


class Instrument(Widget, can_focus=False):
    """An instrument: subclass it, give it a title and `draw`. Nothing is composed or laid out per frame.

    Attributes:
        EVERY: Drawn every so many frames; digits that change faster than ten times a second are not read.
        STALE_S: From this age of its data on, all of it is shown as stale.
    """

    EVERY: ClassVar[int] = 1
    STALE_S: ClassVar[float] = math.inf
    ALLOW_SELECT = False

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self._rows: list[Row] = []
        self._frame: Frame | None = None
        self._styles: dict[Tone, Style] = {}
        self._turn = 0
        self._composed: dict[tuple[Region, Size], list[Strip]] = {}
        self.title = str(self.BORDER_TITLE or "")

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Return the rows of the content area, at most `height` of `width` cells each."""
        raise NotImplementedError

    def every(self) -> int:
        """Return every how many frames it is drawn now."""
        return self.EVERY

    def data_age(self, frame: Frame) -> float:
        """Return the age of what it shows, s; infinite where nothing has come yet, NaN where it has no one age."""
        del frame
        return math.nan

    def footnote(self, frame: Frame) -> str:
        """Return what stands in the lower border while the data is fresh."""
        del frame
        return ""

    def show(self, frame: Frame) -> None:
        """Take a new frame, and paint what changed if it is this instrument's turn."""
        self._frame = frame
        self._turn += 1
        # Before it is mounted, Textual forgets what is asked to be painted.
        if self.is_mounted and self.size and (not self._rows or self._turn % self.every() == 0):
            self._paint(frame)

    def _paint(self, frame: Frame) -> None:
        width, height = self.size
        self._note(frame)
        rows = self.draw(frame, width, height)
        rows.extend([] for _ in range(height - len(rows)))
        if not len(rows) == len(self._rows) == height:
            self._rows = rows
            self.refresh()
            return
        changed = [y for y in range(height) if rows[y] != self._rows[y]]
        self._rows = rows
        if changed:
            self.refresh(*_bands(changed, width))

    def _note(self, frame: Frame) -> None:
        """Write into the upper border what it is and how old, and below the footnote, or that it is stale."""
        age = self.data_age(frame)
        stale = age > self.STALE_S
        if stale != self.has_class(_STALE_CLASS):
            self.set_class(stale, _STALE_CLASS)
            self._rows = []
        old = f"▲ {span_of_time(age)} old" if math.isfinite(age) else "no data yet"
        words = old if stale else self.footnote(frame)
        if words != (self.border_subtitle or ""):
            self.border_subtitle = words
        title = f"{self.title} · {_rounded(age)}" if self.title and math.isfinite(age) else self.title
        if title != (self.border_title or ""):
            self.border_title = title

    def render_lines(self, crop: Region) -> list[Strip]:
        """Return a part as it was composed last if nothing has changed since: others change in every frame."""
        asked = (crop, self.size)
        if asked not in self._composed:
            self._composed[asked] = super().render_lines(crop)
        return self._composed[asked]

    def refresh(
        self, *regions: Region, repaint: bool = True, layout: bool = False, recompose: bool = False
    ) -> Self:
        """Forget what was composed, and have it composed anew."""
        self._composed = {}
        return super().refresh(*regions, repaint=repaint, layout=layout, recompose=recompose)

    def render_line(self, y: int) -> Strip:
        """Return one painted line."""
        width = self.size.width
        styles = self._styles or self._make_styles()
        row = self._rows[y] if y < len(self._rows) else []
        return Strip([Segment(text, styles[tone]) for text, tone in fit(row, width)], width)

    def _make_styles(self) -> dict[Tone, Style]:
        """Return the styles on this widget's ground, all of them the stale one where its data is old."""
        ground = Style(bgcolor=self.background_colors[1].rich_color)
        old, styles = self.has_class(_STALE_CLASS), styles_of(self.app.theme)
        self._styles = {tone: ground + styles[Tone.STALE if old else tone] for tone in Tone}
        return self._styles

    def notify_style_update(self) -> None:
        """Forget the styles when the style sheet, a class or the theme has changed."""
        super().notify_style_update()
        self._styles = {}
        self._composed = {}

    def on_resize(self, _event: events.Resize) -> None:
        """Draw the last frame anew for the new size."""
        self._rows = []
        if self._frame is not None:
            self.show(self._frame)


def _rounded(age: float) -> str:
    """Return an age as long as it is not old: in steps that a healthy one never leaves, so that nothing flickers."""
    return f"<{_FRESH_S:g} s" if age < _FRESH_S else span_of_time(math.floor(10.0 * age) / 10.0)


def _bands(lines: list[int], width: int) -> list[Region]:
    """Return the regions of lines in ascending order; neighbours are one, which is cheaper to compose."""
    bands: list[Region] = []
    for y in lines:
        if bands and bands[-1].bottom == y:
            bands[-1] = Region(0, bands[-1].y, width, y + 1 - bands[-1].y)
        else:
            bands.append(Region(0, y, width, 1))
    return bands
