"""The live view: the same items to a Rerun viewer, through a queue that drops; the file never waits."""

from __future__ import annotations

import contextlib
import queue
import threading

import rerun as rr
import rerun.blueprint as rrb

from groundstation.recording import schema
from groundstation.recording.item import Item, send

# At ten batches a second: a viewer that is busy for that long misses nothing.
_WAITING = 50
_END_S = 1.0


class LiveFeed:
    """A second stream of the flight.

    A viewer that is not there, or reads nothing, blocks this object's own thread for ever and costs memory up
    to Rerun's own bound. At a normal end Rerun waits for such a viewer: leave by `os._exit`.

    Args:
        url: The viewer's, as in `rerun+http://127.0.0.1:9876/proxy`.
        recording_id: The same for all streams of the flight.
        blueprint: Layout it opens in.
    """

    def __init__(self, url: str, recording_id: str, blueprint: rrb.Blueprint) -> None:
        self._queue: queue.Queue[list[Item] | None] = queue.Queue(_WAITING)
        self._url = url
        self._stream = rr.RecordingStream(schema.APPLICATION, recording_id=recording_id)
        self._thread = threading.Thread(target=self._run, args=(blueprint,), name="live", daemon=True)
        self._thread.start()

    def offer(self, items: list[Item]) -> bool:
        """Queue items for the viewer; return False where it does not keep up and they were dropped."""
        try:
            self._queue.put_nowait(items)
        except queue.Full:
            return False
        return True

    def close(self) -> None:
        """Give the viewer a moment for the rest."""
        with contextlib.suppress(queue.Full):
            self._queue.put_nowait(None)
        self._thread.join(_END_S)

    def _run(self, blueprint: rrb.Blueprint) -> None:
        self._stream.connect_grpc(self._url, default_blueprint=blueprint)
        while (items := self._queue.get()) is not None:
            send(self._stream, items)
        with contextlib.suppress(RuntimeError):
            self._stream.flush(timeout_sec=_END_S)
        # Left to the end of the process it would complain of a viewer that ends first.
        self._stream.disconnect()
