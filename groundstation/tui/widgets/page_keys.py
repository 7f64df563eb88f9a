"""The footer of the screens beside the flight: the urgent acts with the keys that work everywhere, then the pages."""

from __future__ import annotations

from collections.abc import Iterator

from textual import events

from groundstation.tui.acts import URGENT
from groundstation.tui.frame import Frame
from groundstation.tui.pages import PAGES
from groundstation.tui.rows import Row, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

Item = tuple[Row, str]


class PageKeys(Instrument):
    """Two lines: what makes things safer, always; the page's own keys and the other pages.

    Args:
        page: Which page it belongs to.
        own: Its own keys: the key, the word, the action.
    """

    EVERY = 3

    def __init__(self, page: str, own: tuple[tuple[str, str, str], ...], *, id: str = "keys") -> None:  # noqa: A002
        super().__init__(id=id)
        self._page, self._own = page, own

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw as many keys a line as there is room for."""
        del height
        return [[span for row, _ in _fitting(line, width) for span in row] for line in self._lines(frame)]

    async def on_click(self, event: events.Click) -> None:
        """Do what the key under the pointer does."""
        if self._frame is None or event.y > 1:
            return
        start = 0
        for row, action in _fitting(tuple(self._lines(self._frame))[event.y], self.size.width):
            end = start + width_of(row)
            if start <= event.x < end:
                await self.run_action(action)
                return
            start = end

    def _lines(self, frame: Frame) -> tuple[Iterator[Item], Iterator[Item]]:
        return self._urgent(frame), self._pages()

    def _urgent(self, frame: Frame) -> Iterator[Item]:
        for act in URGENT:
            possible = not frame.hindrances[act.name]
            yield _item(act.everywhere.upper(), act.label, f"app.urgent('{act.name}')", possible=possible)
        yield _item("Esc", "Back to the flight", "screen.back")

    def _pages(self) -> Iterator[Item]:
        for key, label, action in self._own:
            yield _item(key, label, action)
        for page in PAGES:
            if page.name != self._page:
                yield _item(page.shown, page.label, f"app.page('{page.name}')")
        yield _item("?", "Help", "app.help")
        yield _item("q", "Quit", "app.quit")


def _item(key: str, label: str, action: str, *, possible: bool = True) -> Item:
    if not possible:
        return [(f" {key} {label}", Tone.FAINT)], action
    return [(f" {key}", Tone.KEY), (f" {label}", Tone.TEXT)], action


def _fitting(items: Iterator[Item], width: int) -> list[Item]:
    fitting: list[Item] = []
    for item in items:
        width -= width_of(item[0])
        if width < 0:
            break
        fitting.append(item)
    return fitting
