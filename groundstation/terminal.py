"""Gives a terminal back that a killed screen left in its own state: alternate screen, mouse reports, no cursor."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Mapping
from pathlib import Path

# Kitty keys off; bracketed paste, focus and mouse reports off; main screen; cursor; plain text.
_GIVE_BACK = (
    b"\x1b[<u\x1b[?2004l\x1b[?1004l\x1b[?1000l\x1b[?1002l\x1b[?1003l\x1b[?1015l\x1b[?1006l"
    b"\x1b[?1049l\x1b[?25h\x1b[0m\r\n"
)


def has_screen(environment: Mapping[str, str]) -> bool:
    """Say whether a screen can be shown: on a terminal, or where Textual was given another way, as to a browser."""
    if "TEXTUAL_DRIVER" in environment:
        return True
    return sys.stdin.isatty() and sys.stdout.isatty() and can_redraw(environment)


def can_redraw(environment: Mapping[str, str]) -> bool:
    """Say whether a terminal can write over what it shows; an editor's shell window or a teleprinter cannot."""
    return environment.get("TERM") != "dumb"


def terminal_path() -> str:
    """Return where this process's terminal is, or "" where it has none."""
    try:
        return os.ttyname(sys.stdout.fileno())
    except (OSError, ValueError):
        return ""


def give_back(path: str) -> None:
    """Undo what a screen switched on in a terminal; one that has gone needs nothing."""
    with contextlib.suppress(OSError), Path(path).open("wb", buffering=0) as terminal:
        terminal.write(_GIVE_BACK)
