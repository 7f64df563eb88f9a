"""The footer: which keys do what, those that cannot do it now greyed; a click does the same."""

from __future__ import annotations

from collections.abc import Iterator

from textual import events

from groundstation.tui.acts import ACTS
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

_OTHERS = (("?", "Help", "app.help"), ("q", "Quit", "app.quit"))


class Keys(Instrument):
    """One line of keys."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw key and label of each act, as many as there is room for."""
        del height
        row: Row = []
        for spans, _ in _items(frame):
            if width_of(row) + width_of(spans) <= width:
                row.extend(spans)
        return [row]

    async def on_click(self, event: events.Click) -> None:
        """Do what the key under the pointer does."""
        if self._frame is None:
            return
        start = 0
        for spans, action in _items(self._frame):
            end = start + width_of(spans)
            if start <= event.x < end:
                await self.run_action(action)
                return
            start = end


def _items(frame: Frame) -> Iterator[tuple[Row, str]]:
    for act in ACTS:
        # Disarm shares the place of Arm: one of the two is always impossible.
        hidden = "disarm" if frame.hindrances["disarm"] else "arm"
        if act.name == hidden:
            continue
        possible = not frame.hindrances[act.name]
        yield _item(act.key, act.label, possible=possible), f"app.act('{act.name}')"
    for key, label, action in _OTHERS:
        yield _item(key, label, possible=True), action


def _item(key: str, label: str, *, possible: bool) -> Row:
    if not possible:
        return [(f" {key} {label}", Tone.FAINT)]
    return [(f" {key}", Tone.KEY), (f" {label}", Tone.TEXT)]
