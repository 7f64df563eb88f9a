"""Files and folders that are there whole or not at all: written under another name beside it, then renamed."""

from __future__ import annotations

import os
import shutil
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from groundstation.errors import InputError

# What is in every folder that an export writes: only such a folder is ever replaced.
MARK = "properties.json"


def check(path: Path, *, folder: bool, force: bool) -> None:
    """See that something may be written, before there is work.

    Args:
        path: The file or folder.
        folder: Which of the two.
        force: Replace what an export wrote there before.

    Raises:
        InputError: It may not.
    """
    if not path.parent.is_dir():
        raise InputError(
            f"{path}: cannot be written (there is no folder {path.parent}); choose another --out."
        )
    if not path.exists():
        return
    if not force:
        raise InputError(f"{path}: is there already; choose another --out, or replace it with --force.")
    if path.is_dir() is not folder:
        raise InputError(f"{path}: is a {'file' if folder else 'folder'}; choose another --out.")
    if folder and not (path / MARK).is_file():
        raise InputError(
            f"{path}: was not written by an export, so it is not replaced; choose another --out."
        )


@contextmanager
def written(path: Path, *, folder: bool, force: bool) -> Generator[Path]:
    """Yield where to write; when the block ends well it becomes `path`, else nothing of it is left.

    Args:
        path: The file or folder.
        folder: Which of the two.
        force: Replace what an export wrote there before.

    Raises:
        InputError: It may not be written, or the disk does not take it.
    """
    check(path, folder=folder, force=force)
    draft = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        if folder:
            draft.mkdir()
        yield draft
        if folder and path.exists():
            shutil.rmtree(path)
        draft.replace(path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"{path}: cannot be written ({reason}); free the disk, or choose another --out."
        ) from error
    finally:
        if folder:
            shutil.rmtree(draft, ignore_errors=True)
        else:
            draft.unlink(missing_ok=True)
