"""The file that holds the key for MAVLink signing."""

from __future__ import annotations

import hashlib
import stat
from pathlib import Path

KEY_BYTES = 32
_SHORTEST = 8


class KeyFileError(Exception):
    """A key file cannot be used; the message is one sentence with file, reason and what to do."""


def read_key(path: Path) -> bytes:
    """Return the key in a file: 32 bytes as they are, or the SHA-256 of a passphrase as ground stations take it.

    A file of exactly 32 bytes is a key; anything else is a passphrase in UTF-8, without the newline at its end.

    Raises:
        KeyFileError: It cannot be read, others may read it, or there is too little in it.
    """
    try:
        mode = path.stat().st_mode
        data = path.read_bytes()
    except OSError as error:
        raise KeyFileError(f"{path}: cannot be read ({error.strerror}); check the path.") from error
    if mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise KeyFileError(f"{path}: others may read this key; forbid it with 'chmod 600 {path}'.")
    if len(data) == KEY_BYTES:
        return data
    try:
        passphrase = data.decode().removesuffix("\n").removesuffix("\r")
    except UnicodeDecodeError as error:
        raise KeyFileError(
            f"{path}: is neither {KEY_BYTES} bytes nor a passphrase in UTF-8; make one of the two."
        ) from error
    if len(passphrase) < _SHORTEST:
        raise KeyFileError(f"{path}: a passphrase has {_SHORTEST} characters or more; this one is shorter.")
    return hashlib.sha256(passphrase.encode()).digest()
