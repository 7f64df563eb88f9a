"""The file that holds the key for MAVLink signing."""

from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path

KEY_BYTES = 32
_SHORTEST, _LONGEST = 8, 1024


class KeyFileError(Exception):
    """A key file cannot be used; the message is one sentence with file, reason and what to do."""


def read_key(path: Path) -> bytes:
    """Return the key in a file: 32 bytes as they are, or the SHA-256 of a passphrase as ground stations take it.

    What is text is a passphrase in UTF-8, without the newline at its end, whatever its length: 32 bytes by chance are
    never text.

    Raises:
        KeyFileError: It cannot be read, others may read it, or there is too little or too much in it.
    """
    try:
        # A pipe would be waited for.
        with os.fdopen(os.open(path, os.O_RDONLY | os.O_NONBLOCK), "rb") as file:
            about = os.fstat(file.fileno())
            if not stat.S_ISREG(about.st_mode):
                raise KeyFileError(f"{path}: is no file; name the file with the key.")
            data = file.read(_LONGEST + 1)
    except OSError as error:
        raise KeyFileError(f"{path}: cannot be read ({error.strerror}); check the path.") from error
    if about.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise KeyFileError(f"{path}: others may read this key; forbid it with 'chmod 600 {path}'.")
    return _key_of(data, path)


def _key_of(data: bytes, path: Path) -> bytes:
    try:
        passphrase = data.decode().removesuffix("\n").removesuffix("\r")
    except UnicodeDecodeError:
        passphrase = None
    if len(data) == KEY_BYTES and not (passphrase and passphrase.isprintable()):
        return data
    if passphrase is None or len(data) > _LONGEST:
        raise KeyFileError(
            f"{path}: is neither {KEY_BYTES} bytes nor a passphrase in UTF-8; make one of the two."
        )
    if len(passphrase) < _SHORTEST:
        raise KeyFileError(f"{path}: a passphrase has {_SHORTEST} characters or more; this one is shorter.")
    return hashlib.sha256(passphrase.encode()).digest()
