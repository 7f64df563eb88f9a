"""Keys let go: what the Kitty protocol's bytes become, and what the stick does."""

from __future__ import annotations

import pytest
from cockpit import cockpit
from textual import events
from textual.drivers.headless_driver import HeadlessDriver
from textual.drivers.linux_driver import LinuxDriver

from groundstation.messages import MappingMode
from groundstation.tui.releases import ReleaseDriver, ReleaseParser, driver_for


def keys(data: str) -> list[tuple[str, str | None]]:
    parser = ReleaseParser()
    return [(event.key, event.character) for event in parser.feed(data) if isinstance(event, events.Key)]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ("\x1b[119;;119u", [("w", "w")]),
        ("\x1b[119;1:1;119u", [("w", "w")]),
        ("\x1b[119;1:2;119u", [("w", "w")]),
        ("\x1b[119;1:3u", [("release_w", None)]),
        ("\x1b[119;2:3u", [("release_w", None)]),
        ("\x1b[1;1:1A", [("up", None)]),
        ("\x1b[1;1:2A", [("up", None)]),
        ("\x1b[1;1:3A", [("release_up", None)]),
        ("\x1b[A", [("up", None)]),
        ("\x1b[15;1:3~", [("release_f5", None)]),
        ("\x1b[104;5:1u", [("ctrl+h", None)]),
        ("\x1b[1;1:1A\x1b[100;;100u\x1b[1;1:3A", [("up", None), ("d", "d"), ("release_up", None)]),
        ("h", [("h", "h")]),
    ],
)  # fmt: skip
def test_bytes_become_presses_and_releases(data, expected):
    assert keys(data) == expected


def test_the_terminal_is_asked_for_event_types_and_nothing_else_is_changed():
    written: list[str] = []

    class Written(ReleaseDriver):
        def __init__(self) -> None:
            self._writer_thread = type("Writer", (), {"write": staticmethod(written.append)})()

    driver = Written()
    for data in ("\x1b[>25u", "\x1b[<u", "text \x1b[>25u"):
        driver.write(data)
    assert written == ["\x1b[>27u", "\x1b[<u", "text \x1b[>25u"]


def test_only_a_terminals_driver_is_replaced():
    assert driver_for(LinuxDriver) is ReleaseDriver
    assert driver_for(HeadlessDriver) is HeadlessDriver


@pytest.mark.parametrize(("key", "axis"), [("up", 0), ("right", 1), ("s", 2), ("d", 3)])
async def test_a_key_let_go_centres_its_axis_and_no_other(key, axis):
    async with cockpit() as scene:
        await scene.press("up", "left", "w", "a")
        await scene.press(key, key)
        await scene.press(f"release_{key}")
        share = scene.app.hand.share
        assert share[axis] == 0.0
        assert all(abs(each) == pytest.approx(0.2) for other, each in enumerate(share) if other != axis)


async def test_in_position_mode_the_stick_stays_but_stops_turning():
    async with cockpit() as scene:
        scene.reader.shown.pilot.mapping = MappingMode.POSITION
        await scene.see()
        await scene.press("up", "a", "release_up", "release_a")
        assert scene.app.hand.share == pytest.approx((0.2, 0.0, 0.0, 0.0))


async def test_a_release_over_a_dialog_or_in_a_text_field_does_nothing_else():
    async with cockpit() as scene:
        await scene.press("k", "release_k", "release_y", "release_up")
        assert scene.reader.commands == []
        await scene.press("escape", "f12", "slash", "x", "release_x", "release_w")
        assert scene.app.screen.query_one("#filter").value == "x"
