"""What a page leaves when it is closed: nothing, once it is tidied."""

from __future__ import annotations

import gc
from collections import Counter

from cockpit import cockpit
from textual.strip import Strip
from textual.widget import Widget

from groundstation.tui import memory
from groundstation.tui.pages import PAGES


def alive() -> Counter[type]:
    return Counter(kind for each in gc.get_objects() for kind in (Strip, Widget) if isinstance(each, kind))


async def test_pages_that_were_closed_leave_no_widget_and_no_line_they_painted(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "logs").mkdir()

    async def look_round() -> Counter[type]:
        for page in PAGES:
            await scene.press(page.key)
            await scene.press(page.key)
        await scene.see()
        memory.tidy()
        return alive()

    async with cockpit() as scene:
        first = await look_round()
        assert await look_round() == first
