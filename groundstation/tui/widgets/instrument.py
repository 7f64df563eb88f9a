"""What all instruments share: rows drawn from a frame, of which only those that changed are painted."""

from __future__ import annotations

import math
from typing import ClassVar, NamedTuple, Self

from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.geometry import Region
from textual.strip import Strip

from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, fit, span_of_time
from groundstation.tui.theme import Tone, styles_of
from groundstation.tui.widgets.composed import Composed

_STALE_CLASS = "-stale"
# Younger than this is simply fresh, s.
_FRESH_S = 0.1


class _Edges(NamedTuple):
    """What stands around the content of a line, and where the content is.

    Attributes:
        left, right: Beside it.
        rows: The lines of the whole that have content.
        width: Of the whole, cells.
    """

    left: list[Segment]
    right: list[Segment]
    rows: range
    width: int


class Instrument(Composed, can_focus=False):
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
        self._edges: _Edges | None = None
        self._strips: list[Strip | None] = []
        self._borders = ("", "")
        self._turn = 0
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
        due = not self._rows or self._turn % self.every() == 0
        # Before it is mounted, Textual forgets what is asked to be painted.
        if due and self.is_mounted and self.size:
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
            # With what stands beside it: a line of which a part is painted must be cut first.
            beside = self.gutter
            self.refresh(*_bands(changed, -beside.left, width + beside.width))

    def _note(self, frame: Frame) -> None:
        """Write into the upper border what it is and how old, and below the footnote, or that it is stale."""
        age = self.data_age(frame)
        stale = age > self.STALE_S
        if stale != self.has_class(_STALE_CLASS):
            self.set_class(stale, _STALE_CLASS)
            self._rows = []
        old = f"▲ {span_of_time(age)} old" if math.isfinite(age) else "no data yet"
        below = old if stale else self.footnote(frame)
        above = f"{self.title} · {_rounded(age)}" if self.title and math.isfinite(age) else self.title
        # To ask Textual for what it has makes markup of it each time.
        written, self._borders = self._borders, (above, below)
        if above != written[0]:
            self.border_title = above
        if below != written[1]:
            self.border_subtitle = below

    def render_lines(self, crop: Region) -> list[Strip]:
        """Return the whole, of which only the lines that have changed are composed anew; of a part all are."""
        if crop != self.outer_size.region:
            return super().render_lines(crop)
        if len(self._strips) != crop.height:
            self._strips = [None] * crop.height
        edges = self._edges or self._make_edges()
        strips = [known or self._whole_line(y, edges) for y, known in enumerate(self._strips)]
        self._strips[:] = strips
        return strips

    def _whole_line(self, y: int, edges: _Edges) -> Strip:
        """Return a line of the whole; borders are Textual's."""
        if y not in edges.rows:
            return self.render_part(Region(0, y, edges.width, 1))[0]
        inner = self._segments(y - edges.rows.start, edges.width - len(edges.left) - len(edges.right))
        return Strip([*edges.left, *inner, *edges.right], edges.width)

    def render_line(self, y: int) -> Strip:
        """Return one painted line without its borders."""
        width = self.size.width
        return Strip(self._segments(y, width), width)

    def _segments(self, y: int, width: int) -> list[Segment]:
        styles = self._styles or self._make_styles()
        row = self._rows[y] if y < len(self._rows) else []
        return [Segment(text, styles[tone]) for text, tone in fit(row, width)]

    def refresh(
        self, *regions: Region, repaint: bool = True, layout: bool = False, recompose: bool = False
    ) -> Self:
        """Forget the lines of regions of the content, or all, and have them composed anew."""
        if regions and self._edges is not None and self._strips:
            for y in (y for region in regions for y in region.line_range):
                self._strips[self._edges.rows.start + y] = None
        else:
            self._strips, self._edges = [], None
        return super().refresh(*regions, repaint=repaint, layout=layout, recompose=recompose)

    def _make_edges(self) -> _Edges:
        """Return what stands beside the content, as Textual composes it."""
        (width, height), gutter = self.outer_size, self.gutter
        rows = range(gutter.top, height - gutter.bottom)
        whole = self.render_part(Region(0, gutter.top, width, 1))[0] if rows else Strip([])
        left, right = whole.crop(0, gutter.left), whole.crop(width - gutter.right)
        self._edges = _Edges(list(left), list(right), rows, width)
        return self._edges

    def _make_styles(self) -> dict[Tone, Style]:
        """Return the styles on this widget's ground, all of them the stale one where its data is old.

        What a terminal without colours asks for is done to them once, not to each line.
        """
        background = self.background_colors[1]
        ground = Style(bgcolor=background.rich_color)
        old, styles = self.has_class(_STALE_CLASS), styles_of(self.app.theme)
        segments = [Segment(tone.name, ground + styles[Tone.STALE if old else tone]) for tone in Tone]
        for each in self.get_line_filters():
            segments = each.apply(segments, background)
        self._styles = {tone: segment.style or ground for tone, segment in zip(Tone, segments, strict=True)}
        return self._styles

    def notify_style_update(self) -> None:
        """Forget the styles when the style sheet, a class or the theme has changed."""
        super().notify_style_update()
        self._styles, self._edges, self._strips = {}, None, []

    def on_resize(self, _event: events.Resize) -> None:
        """Draw the last frame anew for the new size."""
        self._rows = []
        if self._frame is not None:
            self.show(self._frame)


def _rounded(age: float) -> str:
    """Return an age as long as it is not old: in steps that a healthy one never leaves, so that nothing flickers."""
    return f"<{_FRESH_S:g} s" if age < _FRESH_S else span_of_time(math.floor(10.0 * age) / 10.0)


def _bands(lines: list[int], x: int, width: int) -> list[Region]:
    """Return the regions of lines in ascending order; neighbours are one, which is cheaper to compose."""
    bands: list[Region] = []
    for y in lines:
        if bands and bands[-1].bottom == y:
            bands[-1] = Region(x, bands[-1].y, width, y + 1 - bands[-1].y)
        else:
            bands.append(Region(x, y, width, 1))
    return bands
