"""The one theme: what each kind of thing looks like.

Colour never speaks alone: faults are also reversed and marked, what is old is also italic and said in words.
"""

from __future__ import annotations

from enum import IntEnum, auto

from rich.style import Style
from textual.theme import Theme

from groundstation.messages import Severity

PALETTE = {
    "ink": "#0a0e14",
    "pane": "#0d131b",
    "frame": "#2b3a4b",
    "text": "#d3dce6",
    "muted": "#7f8fa3",
    "faint": "#465566",
    "ok": "#5fd38d",
    "warn": "#ffcc4d",
    "fault": "#ff5c6c",
    "vehicle": "#58c4ff",
    "trail": "#2f7199",
    "hand": "#c3a6ff",
    "force": "#ff9d5c",
    "simulated": "#1d4f73",
    "real": "#8c1d2c",
}


class Tone(IntEnum):
    """What a piece of text or drawing is, for `STYLES`."""

    TEXT = 0
    STRONG = auto()
    MUTED = auto()
    FAINT = auto()
    GRID = auto()
    OK = auto()
    WARN = auto()
    FAULT = auto()
    VEHICLE = auto()
    TRAIL = auto()
    HAND = auto()
    FORCE = auto()
    TARGET = auto()
    ROUTE = auto()
    OBSTACLE = auto()
    BESIDE = auto()
    STALE = auto()
    KEY = auto()
    CHIP = auto()
    CHIP_OK = auto()
    CHIP_HAND = auto()
    CHIP_FAULT = auto()
    SIMULATED = auto()
    REAL = auto()
    NOTE = auto()
    CAUTION = auto()
    ALARM = auto()


def _style(color: str, background: str = "", *, bold: bool = False, italic: bool = False) -> Style:
    ground = PALETTE[background] if background else None
    return Style(color=PALETTE[color], bgcolor=ground, bold=bold, italic=italic)


STYLES: dict[Tone, Style] = {
    Tone.TEXT: _style("text"),
    Tone.STRONG: _style("text", bold=True),
    Tone.MUTED: _style("muted"),
    Tone.FAINT: _style("faint"),
    Tone.GRID: _style("frame"),
    Tone.OK: _style("ok"),
    Tone.WARN: _style("warn", bold=True),
    Tone.FAULT: _style("ink", "fault", bold=True),
    Tone.VEHICLE: _style("vehicle", bold=True),
    Tone.TRAIL: _style("trail"),
    Tone.HAND: _style("hand", bold=True),
    Tone.FORCE: _style("force", bold=True),
    Tone.TARGET: _style("ok", bold=True),
    Tone.ROUTE: _style("ok"),
    Tone.OBSTACLE: _style("faint"),
    Tone.BESIDE: _style("text"),
    Tone.STALE: _style("muted", italic=True),
    Tone.KEY: _style("vehicle", bold=True),
    Tone.CHIP: _style("text", "frame", bold=True),
    Tone.CHIP_OK: _style("ink", "ok", bold=True),
    Tone.CHIP_HAND: _style("ink", "hand", bold=True),
    Tone.CHIP_FAULT: _style("ink", "fault", bold=True),
    Tone.SIMULATED: _style("text", "simulated", bold=True),
    Tone.REAL: _style("text", "real", bold=True),
    Tone.NOTE: _style("muted"),
    Tone.CAUTION: _style("ink", "warn", bold=True),
    Tone.ALARM: _style("ink", "fault", bold=True),
}

# The shapes that say the severity where there is no colour.
MARKS = {Severity.INFO: " ", Severity.WARNING: "▲", Severity.ALARM: "■"}
TONES = {Severity.INFO: Tone.TEXT, Severity.WARNING: Tone.WARN, Severity.ALARM: Tone.FAULT}

THEME = Theme(
    name="groundstation",
    primary=PALETTE["vehicle"],
    secondary=PALETTE["hand"],
    accent=PALETTE["force"],
    foreground=PALETTE["text"],
    background=PALETTE["ink"],
    surface=PALETTE["pane"],
    panel=PALETTE["frame"],
    success=PALETTE["ok"],
    warning=PALETTE["warn"],
    error=PALETTE["fault"],
    dark=True,
    variables=PALETTE,
)
