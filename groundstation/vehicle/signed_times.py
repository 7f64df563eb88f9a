"""The timestamps that were used under a key, kept beside it: what was recorded before a restart is not heard again.

Source: MAVLink guide, "Message Signing", "Timestamp Handling": they are stored once a minute or more often.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from pathlib import Path

import msgspec

from groundstation.vehicle.signing import NO_TIMES, Signing, Times

_KEEP_S = 5.0
_END_S = 2.0


def times_file(key: Path) -> Path:
    """Return where the timestamps of a key are kept."""
    return key.with_name(f"{key.name}.times")


def read_times(key: Path) -> tuple[Times, str]:
    """Return the timestamps that were used under a key, and what is wrong with them in words, or ""."""
    path = times_file(key)
    try:
        return msgspec.json.decode(path.read_bytes(), type=Times), ""
    except FileNotFoundError:
        return NO_TIMES, ""
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is damaged"
        return NO_TIMES, f"{path} cannot be read ({why}): what was recorded before could be played again."


class TimesKeeper:
    """Keeps them on a thread: a disk that hangs holds nothing up.

    Args:
        key: The key's file.
        signing: Whose they are.
        on_failure: Told once in words when they cannot be kept.
    """

    def __init__(self, key: Path, signing: Signing, on_failure: Callable[[str], None]) -> None:
        self._path, self._signing, self._on_failure = times_file(key), signing, on_failure
        self._over = threading.Event()
        self._failed = False
        self._thread = threading.Thread(target=self._run, name="signed-times", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Keep the last ones and end."""
        self._over.set()
        self._thread.join(_END_S)

    def _run(self) -> None:
        while not self._over.wait(_KEEP_S):
            self._keep()
        self._keep()

    def _keep(self) -> None:
        new = self._path.with_name(f"{self._path.name}.new")
        try:
            with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
                file.write(msgspec.json.encode(self._signing.times()))
                file.flush()
                os.fsync(file.fileno())
            new.replace(self._path)
        except OSError as error:
            if not self._failed:
                self._failed = True
                self._on_failure(
                    f"{self._path} cannot be written ({error.strerror}): what is recorded now could be played again "
                    "after a restart."
                )
