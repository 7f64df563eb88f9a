"""A long flight's recording in several files: `NAME.rrd`, `NAME.part-2.rrd` and so on, each complete for itself."""

from __future__ import annotations

import fcntl
import os
import re
from pathlib import Path

SUFFIX = ".rrd"
_PART = re.compile(r"\.part-(\d+)$")


def part_path(first: Path, number: int) -> Path:
    """Return the path of a flight's part; the first has the flight's own name."""
    return first if number == 1 else first.with_name(f"{first.stem}.part-{number}{SUFFIX}")


def is_part(path: Path) -> bool:
    """Say whether a recording is a later part of a flight."""
    return _PART.search(path.stem) is not None


def parts_of(first: Path) -> list[Path]:
    """Return a flight's files in their order, the first of them as given whether it is there or not."""
    later = [path for path in first.parent.glob(f"{_escaped(first.stem)}.part-*{SUFFIX}") if is_part(path)]
    return [first, *sorted(later, key=_number)]


def is_growing(path: Path) -> bool:
    """Say whether a recorder is writing the file now: it holds the file's lock."""
    fd = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(fd, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    finally:
        os.close(fd)
    return False


def _number(path: Path) -> int:
    found = _PART.search(path.stem)
    assert found is not None
    return int(found[1])


def _escaped(stem: str) -> str:
    return re.sub(r"([*?[])", r"[\1]", stem)
