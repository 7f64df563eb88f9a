"""The MAVLink log: every frame in and out with its time, as MAVProxy, QGroundControl and mavlogdump read it.

Format: eight bytes big-endian microseconds since 1970, then the frame. A thread of its own writes, so that a
slow or full disk costs the link nothing.
"""

from __future__ import annotations

import os
import queue
import struct
import threading
import time
from collections.abc import Callable
from pathlib import Path

_STAMP = struct.Struct(">Q")
_SYNC_S = 1.0
_QUEUE_FRAMES = 50_000


class TlogWriter:
    """Writes a `.tlog`. Once it is open it never raises: a disk that fails, or is too slow, is told once.

    Args:
        path: The file; it must not exist.
        on_failure: Told in words when the disk fails or frames are lost to it.

    Raises:
        OSError: The file cannot be created.
    """

    def __init__(self, path: Path, on_failure: Callable[[str], None]) -> None:
        self._path = path
        self._on_failure = on_failure
        self._frames: queue.Queue[tuple[int, bytes] | None] = queue.Queue(_QUEUE_FRAMES)
        self._lossy = False
        self._file = path.open("xb", buffering=0)
        self._thread = threading.Thread(target=self._write_all, name="tlog", daemon=True)
        self._thread.start()

    def write(self, frame: bytes) -> None:
        """Log a frame as of now."""
        try:
            self._frames.put_nowait((time.time_ns() // 1000, frame))
        except queue.Full:
            if not self._lossy:
                self._lossy = True
                self._on_failure(f"MAVLink log {self._path} misses frames: the disk does not keep up.")

    def close(self) -> None:
        """Write what is left and close the file."""
        self._frames.put(None)
        self._thread.join(timeout=2.0)

    def _write_all(self) -> None:
        synced = time.monotonic()
        try:
            with self._file as file:
                while (batch := self._next_batch()) is not None:
                    file.write(batch)
                    if time.monotonic() - synced > _SYNC_S:
                        os.fsync(file.fileno())
                        synced = time.monotonic()
        except OSError as error:
            self._on_failure(
                f"MAVLink log {self._path} stopped ({error.strerror}); free the disk and restart."
            )
            while self._frames.get() is not None:
                pass

    def _next_batch(self) -> bytes | None:
        """Wait for frames and return all there are, or None at the end."""
        item = self._frames.get()
        if item is None:
            return None
        parts = [_STAMP.pack(item[0]), item[1]]
        while len(parts) < 200 and not self._frames.empty():
            item = self._frames.get()
            if item is None:
                self._frames.put(None)
                break
            parts += (_STAMP.pack(item[0]), item[1])
        return b"".join(parts)
