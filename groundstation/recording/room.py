"""Room for recordings: the oldest flights go where their folder has a limit, and a disk that gets full is told."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from groundstation.recording.parts import SUFFIX, is_growing

# Only files that this program named itself are ever removed.
_OURS = re.compile(r"(\d{4}-\d\d-\d\d_\d\d-\d\d-\d\d_.+?)(\.part-\d+)?\.(rrd|tlog)")
_GB = 1e9


def make_room(folder: Path, limit_gb: float, keep: str) -> list[str]:
    """Remove the oldest flights, recordings with their MAVLink logs, until those left are within the limit.

    Args:
        folder: Where recordings are.
        limit_gb: What all of them may take; 0 for no limit.
        keep: Name of the flight that begins now. It stays, as does what is still being written.

    Returns:
        The names of the flights that were removed, oldest first.
    """
    if not limit_gb:
        return []
    flights: dict[str, list[Path]] = {}
    for path in sorted(folder.iterdir()):
        if (found := _OURS.fullmatch(path.name)) and path.is_file():
            flights.setdefault(found[1], []).append(path)
    sizes = {name: sum(path.stat().st_size for path in files) for name, files in flights.items()}
    removed: list[str] = []
    for name in sorted(flights):
        if sum(sizes.values()) <= limit_gb * _GB:
            break
        files = flights[name]
        if name == keep or any(path.suffix == SUFFIX and is_growing(path) for path in files):
            continue
        for path in files:
            path.unlink(missing_ok=True)
        del sizes[name]
        removed.append(name)
    return removed


def left_gb(folder: Path) -> float:
    """Return how much the folder's disk still takes, GB; infinite where nobody knows."""
    try:
        return shutil.disk_usage(folder).free / _GB
    except OSError:
        return float("inf")
