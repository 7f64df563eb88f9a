"""Recordings as files: whether one is whole, still being written, or to be put in order before it is read."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
import warnings
from pathlib import Path

from rerun.chunk import Chunk, RrdReader

from groundstation.errors import InputError
from groundstation.recording.parts import parts_of
from groundstation.recording.program import optimise


def open_reader(path: Path) -> RrdReader:
    """Open a recording for reading.

    Raises:
        InputError: It is not there, or not a Rerun recording.
    """
    if not path.is_file():
        raise InputError(
            f"{path}: there is no such recording; 'groundstation review --list' shows those there are."
        )
    try:
        with warnings.catch_warnings():
            # It warns of a missing index, which `is_whole` tells.
            warnings.simplefilter("ignore")
            return RrdReader(path)
    except (RuntimeError, ValueError, OSError) as error:
        raise InputError(f"{path}: is not a Rerun recording; give an .rrd file of a flight.") from error


def is_whole(reader: RrdReader) -> bool:
    """Say whether a recording was ended properly; then its index is at its end."""
    try:
        reader.store()
    except RuntimeError:
        return False
    return True


def mend(path: Path) -> None:
    """Put a recording in order, in place, that ended without an index or in the middle of a row.

    Raises:
        InputError: Nothing of it can be read, or its folder is not writable.
    """
    if not optimise(path):
        raise InputError(f"{path}: did not end properly and cannot be mended; is its folder writable?")


def read_chunks(path: Path) -> list[Chunk]:
    """Return all of a recording with its later parts, whole or not; the files stay as they are.

    Raises:
        InputError: It cannot be read. A later part that cannot is left out.
    """
    first, *later = parts_of(path)
    chunks = _chunks(first)
    for part in later:
        with contextlib.suppress(InputError):
            chunks += _chunks(part)
    return chunks


def _chunks(path: Path) -> list[Chunk]:
    reader = open_reader(path)
    try:
        return (reader.store() if is_whole(reader) else reader).stream().to_chunks()
    except RuntimeError:
        # It ends in the middle of a row: what comes before is read from a mended copy.
        with tempfile.TemporaryDirectory(prefix="groundstation-mend-") as folder:
            copy = Path(folder) / path.name
            shutil.copyfile(path, copy)
            mend(copy)
            return open_reader(copy).store().stream().to_chunks()
