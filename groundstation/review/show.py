"""`groundstation review`: the flights there are, and one of them in the Rerun viewer."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from groundstation.errors import InputError
from groundstation.recording.live import free_tcp_port, has_display, page_address
from groundstation.recording.program import ENVIRONMENT, LOOPBACK, program
from groundstation.review.listing import Entry, list_flights

# A flight is looked at whole: data that do not fit drop out, the oldest first.
_MEMORY = ("--memory-limit", "75%", "--server-memory-limit", "2GB")

Spawn = Callable[[Sequence[str]], int]


def run(asked: argparse.Namespace) -> int:
    """Do what was asked and return the exit code.

    Raises:
        InputError: There is no such recording, or no way to show it.
    """
    return list_all(asked.logs) if asked.list else show(asked.log, asked.logs, web=asked.web)


def list_all(folder: Path) -> int:
    """Print the flights in a folder, newest first, a line each; return the exit code."""
    entries = list_flights(folder)
    for entry in entries:
        sys.stdout.write(f"{_line(entry)}\n")
    if not entries:
        sys.stdout.write(f"No flights in {folder}.\n")
    return 0


def show(log: Path | None, folder: Path, *, web: bool = False) -> int:
    """Open a recording in the viewer and wait until it is closed.

    Args:
        log: The recording; None for the newest in the folder.
        folder: Where recordings are.
        web: In a browser on this machine instead of a window.

    Returns:
        The exit code.

    Raises:
        InputError: There is no such recording, or no way to show it.
    """
    return review(log or _newest(folder), web=web)


def review(
    log: Path, *, web: bool = False, environment: Mapping[str, str] = os.environ, spawn: Spawn | None = None
) -> int:
    """Open a recording in the viewer and wait until it is closed.

    Args:
        log: The recording. One that did not end properly is put in order first.
        web: In a browser on this machine instead of a window.
        environment: Tells whether there is a display.
        spawn: Runs a command and returns its exit code.

    Returns:
        The exit code.

    Raises:
        InputError: There is no such recording, or no way to show it.
    """
    _put_in_order(log)
    if not web and not has_display(environment):
        raise InputError("there is no display to open the viewer on; look in a browser with --web.")
    port = free_tcp_port()
    command = [str(program()), *LOOPBACK, "--port", str(port), *_MEMORY]
    if web:
        page_port = free_tcp_port()
        command += ["--serve-web", "--web-viewer-port", str(page_port)]
        page = page_address(page_port, f"rerun+http://127.0.0.1:{port}/proxy")
        sys.stderr.write(f"{log.name} is at {page}\nCtrl-C ends.\n")
    return (spawn or _run)([*command, str(log.resolve())])


def _newest(folder: Path) -> Path:
    entries = list_flights(folder)
    if not entries:
        raise InputError(f"{folder}: there are no recorded flights; name a recording or choose --logs.")
    return entries[0].path


def _put_in_order(log: Path) -> None:
    from groundstation.review.rrd import is_growing, is_whole, mend, open_reader

    if is_whole(open_reader(log)):
        return
    if is_growing(log):
        sys.stderr.write(f"{log.name} is still being recorded: this is the flight so far.\n")
        return
    sys.stderr.write(f"{log.name} did not end properly: putting it in order.\n")
    mend(log)


def _run(command: Sequence[str]) -> int:
    try:
        return subprocess.call(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, **ENVIRONMENT},
        )
    except KeyboardInterrupt:
        return 0


def _line(entry: Entry) -> str:
    length = "not ended" if entry.duration is None else f"{entry.duration:7.1f} s"
    started = entry.started.astimezone().strftime("%Y-%m-%d %H:%M:%S")
    return f"{started}  {length:>9}  {entry.size / 1e6:7.1f} MB  {entry.mission or '-':<12}  {entry.path}"
