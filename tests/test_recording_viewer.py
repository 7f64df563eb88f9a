"""A recording in the real viewer: no view complains, whatever tab is in front."""

from __future__ import annotations

import sys
import threading
import urllib.parse
from pathlib import Path

import pytest
from recording_support import a_run, until
from test_review_flight import record

from groundstation.errors import InputError
from groundstation.recording import live
from groundstation.recording.blueprint import blueprint
from groundstation.recording.live import free_tcp_port, start_viewer
from groundstation.review.jump import go_to

sys.path.append(str(Path(__file__).resolve().parents[1] / "docs" / "pictures"))
from headless_viewer import HeadlessViewer, ViewerError

pytestmark = pytest.mark.flight


@pytest.fixture
def viewer():
    try:
        started = HeadlessViewer()
    except ViewerError as error:
        pytest.skip(f"no picture here: {error}")
    with started:
        yield started


def test_no_view_complains(tmp_path, viewer):
    viewer.open(record(tmp_path))
    viewer.go_to(None)
    for tab in range(4):
        viewer.turn_tabs(tab)
        viewer.picture(tmp_path / f"{tab}.png")
        assert viewer.complaints() == []
        assert (tmp_path / f"{tab}.png").stat().st_size > 50_000


@pytest.mark.parametrize("mission", [True, False], ids=["mission", "free flight"])
def test_there_is_a_layout(tmp_path, mission):
    assert blueprint(a_run(tmp_path, mission=mission).mission).root_container


def listeners(port: int) -> set[str]:
    """Return the addresses that are listened on at a port, as Linux's hexadecimal words."""
    rows = [line.split() for line in Path("/proc/net/tcp").read_text(encoding="ascii").splitlines()[1:]]
    places = [row[1].split(":") for row in rows if row[3] == "0A"]
    return {address for address, number in places if int(number, 16) == port}


def test_a_live_viewer_without_a_display_is_a_page_on_loopback_only(capsys):
    url = start_viewer({})
    page = capsys.readouterr().err.split()[-1]
    assert url.startswith("rerun+http://127.0.0.1:")
    assert page.startswith("http://127.0.0.1:")
    for address in (url, page):
        port = urllib.parse.urlsplit(address).port
        assert port
        until(lambda port=port: bool(listeners(port)), "the page")
        assert listeners(port) == {"0100007F"}


def test_a_viewer_that_does_not_start_is_said_in_a_sentence(monkeypatch):
    monkeypatch.setattr(live, "program", lambda: Path("/bin/false"))
    with pytest.raises(InputError, match="fly without --rerun"):
        start_viewer({})


def test_without_a_graphics_driver_there_is_no_picture(monkeypatch):
    monkeypatch.setenv("VK_DRIVER_FILES", "/nonexistent")
    monkeypatch.setenv("VK_ICD_FILENAMES", "/nonexistent")
    with pytest.raises(ViewerError, match="Vulkan"):
        HeadlessViewer()


def test_the_viewer_is_taken_to_a_moment_once_it_has_loaded(tmp_path, viewer):
    path = record(tmp_path)
    port = urllib.parse.urlsplit(viewer._client.url).port
    opening = threading.Thread(target=viewer.open, args=(path,))
    opening.start()
    assert go_to(port, 1.25)
    opening.join()
    state = viewer._client.get_state()
    assert state.recordings[0].current_time == 1_250_000_000


def test_a_viewer_that_was_closed_is_not_waited_for():
    assert not go_to(free_tcp_port(), 1.0, running=lambda: False)
