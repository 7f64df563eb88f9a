"""Widgets whose strips are kept: in every frame something beside or below them changes, and they do not."""

from __future__ import annotations

from typing import Self

from textual.containers import Horizontal, Vertical
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget


class Composed(Widget):
    """Returns what it composed last, as long as it is neither refreshed nor styled anew."""

    def __init__(
        self,
        *children: Widget,
        name: str | None = None,
        id: str | None = None,  # noqa: A002 - Textual's own name
        classes: str | None = None,
    ) -> None:
        super().__init__(*children, name=name, id=id, classes=classes)
        self._composed: dict[tuple[Region, Size], list[Strip]] = {}

    def render_lines(self, crop: Region) -> list[Strip]:
        """Return a part of it, in its own cells."""
        asked = (crop, self.outer_size)
        if asked not in self._composed:
            self._composed[asked] = self.render_part(crop)
        return self._composed[asked]

    def render_part(self, crop: Region) -> list[Strip]:
        """Return a part of it as Textual composes it now."""
        return super().render_lines(crop)

    def refresh(
        self, *regions: Region, repaint: bool = True, layout: bool = False, recompose: bool = False
    ) -> Self:
        """Forget what was composed, and have it composed anew."""
        self._composed = {}
        return super().refresh(*regions, repaint=repaint, layout=layout, recompose=recompose)

    def notify_style_update(self) -> None:
        """Forget what was composed when the style sheet, a class or the theme has changed."""
        super().notify_style_update()
        self._composed = {}


class Across(Horizontal, Composed):
    """Side by side."""


class Down(Vertical, Composed):
    """One under the other."""
