"""A run's folder: what its processes share on disk, who is still in it, and how nothing of it stays behind.

Every process of a run holds a shared lock on a file in it, which the system lets go when the process ends,
however it ends. Who can lock it alone is the last, and sweeps folder and shared memory.
"""

from __future__ import annotations

import fcntl
import os
import re
import secrets
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

PREFIX = "groundstation-"
_RUN_ID = re.compile(r"\d+-[0-9a-f]{6}")
_LOCK = "alive"
_SHARED_MEMORY = Path("/dev/shm")  # noqa: S108 - where Linux keeps POSIX shared memory; elsewhere it is absent
# A folder without a lock file may belong to a program that is just starting.
_YOUNG_S = 60.0


def new_run_id() -> str:
    """Return a name for a run that no other has: the supervisor's process id and something random."""
    return f"{os.getpid()}-{secrets.token_hex(3)}"


def run_folder(run_id: str) -> Path:
    """Return the folder of a run's files: the bus's, the run file, sockets, the output of its processes."""
    return Path(tempfile.gettempdir()) / f"{PREFIX}{run_id}"


def own_folder(run_id: str) -> Path:
    """Return a run's folder, which is made if it is not there; nobody else may look into it.

    Raises:
        PermissionError: There is one that is another user's.
    """
    folder = run_folder(run_id)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not _is_ours(folder):
        raise PermissionError(f"{folder} is another user's")
    return folder


class Stay:
    """A process's stay in a run, from `Stay(run_id)` to its end.

    Args:
        run_id: The run; its folder is made if it is not there.
    """

    def __init__(self, run_id: str) -> None:
        self._file: IO[bytes] = (own_folder(run_id) / _LOCK).open("ab")
        fcntl.flock(self._file, fcntl.LOCK_SH)

    def end(self) -> bool:
        """Leave, and say whether nobody is left."""
        last = _alone(self._file)
        self._file.close()
        return last


def sweep(run_id: str) -> None:
    """Remove all that a run left in shared memory and on disk. Only when its processes are gone."""
    for segment in _SHARED_MEMORY.glob(f"{PREFIX}{run_id}_*"):
        segment.unlink(missing_ok=True)
    shutil.rmtree(run_folder(run_id), ignore_errors=True)


def sweep_dead_runs() -> None:
    """Remove what runs left behind whose every process has died, as after SIGKILL of all of them.

    Other folders that begin alike are somebody's, such as a comparison that is being looked at. So are other users':
    whoever likes makes a folder or a link of such a name where all keep their temporary files.
    """
    for run_id, folder in _folders():
        if _is_dead(folder):
            sweep(run_id)


def living_runs() -> list[str]:
    """Return the runs in which somebody is."""
    return [run_id for run_id, folder in _folders() if folder.is_dir() and not _is_dead(folder)]


def _folders() -> Iterator[tuple[str, Path]]:
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*-*"):
        run_id = folder.name.removeprefix(PREFIX)
        if _RUN_ID.fullmatch(run_id) and _is_ours(folder):
            yield run_id, folder


def _is_ours(folder: Path) -> bool:
    """Say whether a folder is this user's own, and no link to one."""
    try:
        about = folder.lstat()
    except OSError:
        return False
    return stat.S_ISDIR(about.st_mode) and about.st_uid == os.geteuid()


def _is_dead(folder: Path) -> bool:
    """Say whether no process is in a run's folder; one that is not ours to open is not ours to judge."""
    try:
        with (folder / _LOCK).open("rb") as file:
            return _alone(file)
    except FileNotFoundError:
        return folder.is_dir() and time.time() - folder.stat().st_mtime > _YOUNG_S
    except OSError:
        return False


def _alone(file: IO[bytes]) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
