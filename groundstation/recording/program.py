"""The Rerun program that comes with the package: the viewer, and the tool that puts a recording in order."""

from __future__ import annotations

import importlib.util
import subprocess
from pathlib import Path

# Tells the viewer that a program started it: no greetings on the terminal.
ENVIRONMENT = {"RERUN_APP_ONLY": "true"}
# The viewer listens on all interfaces unless told not to.
LOOPBACK = ("--bind", "127.0.0.1")


def program() -> Path:
    """Return the path of the `rerun` executable.

    Raises:
        FileNotFoundError: The package is installed without it.
    """
    found = importlib.util.find_spec("rerun_cli")
    path = Path(found.origin).with_name("rerun") if found and found.origin else None
    if path is None or not path.is_file():
        raise FileNotFoundError("the rerun program is missing; install rerun-sdk again.")
    return path


def optimise(recording: Path, timeout: float | None = None) -> bool:
    """Put a recording in order, in place: its rows into large chunks, and an index at its end.

    A recording that ended in the middle of a write is cut after the last whole row. The original stays as it
    is until the new file is complete.

    Args:
        recording: The file.
        timeout: When to give up, s; None never does.

    Returns:
        Whether it was done; where not, the file is as it was.
    """
    ordered = recording.with_name(f".{recording.stem}.ordered.rrd")
    command = (
        program(),
        "rrd",
        "optimize",
        "--profile",
        "live",
        "--continue-on-error",
        "-o",
        ordered,
        recording,
    )
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=timeout,
            check=False,
            start_new_session=True,
        )
        if done.returncode == 0 and ordered.stat().st_size > 0:
            ordered.replace(recording)
            return True
    except (OSError, subprocess.TimeoutExpired):
        pass
    finally:
        ordered.unlink(missing_ok=True)
    return False
