"""The Rerun viewer without a window, for pictures and for checking that a recording shows without errors."""

from __future__ import annotations

import os
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from rerun.experimental import ViewerClient

from groundstation.recording.live import free_tcp_port, listening
from groundstation.recording.program import ENVIRONMENT, LOOPBACK, program
from groundstation.recording.schema import TIMELINE

_START_S = 30.0
_LOAD_S = 60.0
# Notes that the viewer shows over the window's corner when it starts fade within this.
_NOTES_S = 6.0
_POLL_S = 0.1
# A plot's axes glide to the data within this.
_REST_S = 8.0


class ViewerError(Exception):
    """The viewer cannot be used; the message says why."""


class HeadlessViewer:
    """A viewer that listens on loopback only. Use it in a `with` block.

    Args:
        size: Of its window, points.

    Raises:
        ViewerError: It does not start, as without a graphics driver.
    """

    def __init__(self, size: str = "1920x1080") -> None:
        port = free_tcp_port()
        self._process = subprocess.Popen(
            [
                program(),
                "--headless",
                "--window-size",
                size,
                "--port",
                str(port),
                *LOOPBACK,
                "--memory-limit",
                "2GB",
                "--hide-welcome-screen",
            ],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, **ENVIRONMENT},
        )
        self._started = time.monotonic()
        if not _until(lambda: self._ended() or self._answers(port), _START_S) or self._ended():
            self._process.kill()
            self._process.wait()
            raise ViewerError("the viewer does not start; it needs a Vulkan driver.")

    def __enter__(self) -> Self:
        """Return the viewer."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the viewer."""
        self._process.terminate()
        self._process.wait()

    def open(self, recording: Path) -> None:
        """Open a recording and wait until it is loaded.

        Raises:
            ViewerError: It does not load.
        """
        self._client.open(str(recording.resolve()))
        if not _until(self._loaded, _LOAD_S):
            raise ViewerError(f"{recording}: the viewer does not load it.")

    def go_to(self, moment: float | None) -> None:
        """Show a moment of the flight, s; None shows three quarters of it."""
        timelines = self._client.get_state().recordings[0].timelines
        last = next(line.end for line in timelines if line.name == TIMELINE) or 0
        self._client.set_time(
            TIMELINE, duration=0.75e-9 * last if moment is None else moment, play_state="paused"
        )

    def turn_tabs(self, place: int) -> None:
        """Bring the tab at this place (0 is the first) to the front wherever there are tabs, or the last."""
        layout = self._client.get_blueprint("recording").blueprint
        for parts in layout.values():
            container = parts.get("ContainerBlueprint", {})
            if container.get("container_kind") == "Tabs":
                container["active_tab"] = container["contents"][min(place, len(container["contents"]) - 1)]
        self._client.set_blueprint(layout, "recording")

    def picture(self, path: Path, view: str | None = None) -> None:
        """Save what is shown as a PNG: the whole window, or the one view whose name begins so."""
        time.sleep(max(0.0, self._started + _NOTES_S - time.monotonic()))
        views = self._client.get_state().views
        view_id = next((v.view_id for v in views if view and v.name.startswith(view)), None)
        last = b""

        def at_rest() -> bool:
            """Say whether the picture is the one before: axes glide to their ranges."""
            nonlocal last
            before = last
            self._client.save_screenshot(str(path.resolve()), view_id)
            last = path.read_bytes()
            return last == before

        _until(at_rest, _REST_S)

    def complaints(self) -> list[str]:
        """Return what views say went wrong, a sentence each."""
        views = self._client.get_state().views
        return [
            f"{view.name}: {report.summary}: {report.details}" for view in views for report in view.reports
        ]

    def _ended(self) -> bool:
        return self._process.poll() is not None

    def _answers(self, port: int) -> bool:
        """Say whether the viewer paints: it opens its port, and even answers, before it has found a driver."""
        if not listening(port):
            return False
        try:
            self._client = ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
            with tempfile.TemporaryDirectory() as folder:
                self._client.save_screenshot(str(Path(folder) / "first.png"))
        except (ConnectionError, RuntimeError):
            return False
        return True

    def _loaded(self) -> bool:
        state = self._client.get_state()
        return not state.loading and any(recording.timelines for recording in state.recordings)


def _until(condition: Callable[[], bool], limit: float) -> bool:
    deadline = time.monotonic() + limit
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(_POLL_S)
    return True
