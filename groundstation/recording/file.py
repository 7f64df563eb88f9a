"""The recording on disk: written in batches, on the platter every second, put in order at the end.

What fails here is told in words and stops nothing: the recorder goes on taking records off the bus.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import shutil
import threading
from collections.abc import Iterable
from pathlib import Path

import rerun as rr
import rerun.blueprint as rrb
import rerun_bindings

from groundstation.failsafe import BY_FAULT, Fault
from groundstation.recording import schema
from groundstation.recording.item import Item, send
from groundstation.recording.program import optimise

SYNC_S = 1.0
# Longest the end of a flight waits for its recording to be put in order: 40 minutes' worth, measured.
_ORDER_S = 5.0
_FLUSH_S = 10.0
_FULL_BYTES = 1 << 20
_FULL = BY_FAULT[Fault.DISK_FULL]
# Rerun 0.41 makes a stream while it holds the interpreter, and waits for its list of streams. `free_ended` holds that
# list, and waits for a stream to be written out, which needs the interpreter to let go of our numbers: never both.
_STREAMS = threading.Lock()


class RecordingError(Exception):
    """The flight cannot be recorded, or no longer; the message says why and what to do."""


class FlightFile:
    """One flight's recording.

    Args:
        path: Where it shall be. A file that is there already is left alone: this one gets a number.
        recording_id: The same for all streams of the flight.
        blueprint: Layout it opens in; None leaves it to the viewer, or to another file of the same flight.

    Raises:
        RecordingError: The file cannot be made.
    """

    def __init__(self, path: Path, recording_id: str, blueprint: rrb.Blueprint | None) -> None:
        self.path, self._fd = _take(path)
        with _STREAMS:
            self._stream = rr.RecordingStream(schema.APPLICATION, recording_id=recording_id)
        self._failure = ""
        try:
            # With one it would keep something of every chunk in memory, 0.3 MB a second; `close` adds it.
            self._stream.save(self.path, default_blueprint=blueprint, write_footer=False)
        except RuntimeError as error:
            os.close(self._fd)
            self.path.unlink(missing_ok=True)
            raise RecordingError(_sentence(self.path)) from error
        self._closing = threading.Event()
        self._syncer = threading.Thread(target=self._sync, name="sync", daemon=True)
        self._syncer.start()

    def write(self, items: Iterable[Item]) -> None:
        """Add items; never waits for the disk.

        Raises:
            RecordingError: The file can no longer be written. What it held before stays readable.
        """
        if self._failure:
            raise RecordingError(self._failure)
        send(self._stream, items)

    @property
    def size(self) -> int:
        """Bytes that it has grown to."""
        return os.fstat(self._fd).st_size

    def close(self) -> bool:
        """Write out what is left, end the file, and put it in order; return False where that took too long.

        Raises:
            RecordingError: Not everything could be written.
        """
        self._closing.set()
        self._syncer.join()
        self._flush()
        self._stream.disconnect()
        del self._stream
        with contextlib.suppress(OSError):
            os.fsync(self._fd)
        try:
            if self._failure:
                raise RecordingError(self._failure)
            return optimise(self.path, _ORDER_S)
        finally:
            os.close(self._fd)

    def _sync(self) -> None:
        """Bring what is written onto the disk every second, beside the loop that reads the bus."""
        while not self._failure and not self._closing.wait(SYNC_S):
            self._flush()

    def _flush(self) -> None:
        try:
            self._stream.flush(timeout_sec=_FLUSH_S)
            os.fsync(self._fd)
        except (RuntimeError, OSError):
            self._failure = _sentence(self.path)


def free_ended() -> None:
    """Give back what ended streams have taken; Rerun 0.41 keeps 4 MB and two threads of each until it is asked.

    It waits for what others that still run have to send: no stream to a viewer may be open, which may never read.
    """
    with _STREAMS:
        rerun_bindings.flush_and_cleanup_orphaned_recordings()


def _take(path: Path) -> tuple[Path, int]:
    """Make a new file at path, or beside it where there is one; its lock tells readers that it grows."""
    taken = path
    number = 2
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        while True:
            try:
                fd = os.open(taken, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)
                break
            except FileExistsError:
                taken = path.with_name(f"{path.stem}_{number}{path.suffix}")
                number += 1
    except OSError as error:
        raise RecordingError(
            f"This flight is not recorded: {taken} cannot be made ({error.strerror}); choose another folder."
        ) from error
    # Some network file systems know no locks; the recording does not need one.
    with contextlib.suppress(OSError):
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return taken, fd


def _sentence(path: Path) -> str:
    try:
        full = shutil.disk_usage(path.parent).free < _FULL_BYTES
    except OSError:
        full = False
    why = os.strerror(errno.ENOSPC) if full else "the disk refuses it"
    return f"{_FULL.words}: {path} cannot be written ({why}); free the disk and start anew."
