"""The themes: what each kind of thing looks like, dark, light and in high contrast.

Colour never speaks alone: faults are also reversed and marked, what is old is also italic and said in words.
"""

from __future__ import annotations

from enum import IntEnum, auto
from functools import cache

from rich.style import Style
from textual.theme import Theme

from groundstation.messages import Severity

# A palette a theme. `on` is written on the bright grounds (ok, warn, fault, hand), `bright` on the deep ones
# (simulated, real).
PALETTES: dict[str, dict[str, str]] = {
    "dark": {
        "ink": "#0a0e14", "pane": "#0d131b", "frame": "#2b3a4b", "text": "#d3dce6", "muted": "#8796a9",
        "faint": "#52627a", "ok": "#5fd38d", "warn": "#ffcc4d", "fault": "#ff5c6c", "vehicle": "#58c4ff",
        "trail": "#3a86b5", "faded": "#24567a", "hand": "#c3a6ff", "force": "#ff9d5c", "sky": "#14304a",
        "ground": "#7a5a33", "simulated": "#1d4f73", "real": "#8c1d2c", "on": "#0a0e14", "bright": "#f2f6fa",
    },
    "light": {
        "ink": "#fbfaf6", "pane": "#f1efe8", "frame": "#c3bfb3", "text": "#20262e", "muted": "#5d6673",
        "faint": "#979c9f", "ok": "#12713c", "warn": "#8a5a00", "fault": "#b3122a", "vehicle": "#0a5fa8",
        "trail": "#4f8fc4", "faded": "#a3c3dd", "hand": "#6a35c0", "force": "#b44a00", "sky": "#cfe4f5",
        "ground": "#a98452", "simulated": "#2c6c9c", "real": "#a3142b", "on": "#ffffff", "bright": "#ffffff",
    },
    "contrast": {
        "ink": "#000000", "pane": "#000000", "frame": "#8c8c8c", "text": "#ffffff", "muted": "#dcdcdc",
        "faint": "#a8a8a8", "ok": "#00ff7f", "warn": "#ffff00", "fault": "#ff6a6a", "vehicle": "#00e5ff",
        "trail": "#00a9bd", "faded": "#007a8a", "hand": "#e7b3ff", "force": "#ffae42", "sky": "#003a66",
        "ground": "#c08a3e", "simulated": "#004c99", "real": "#b30021", "on": "#000000", "bright": "#ffffff",
    },
}  # fmt: skip
DARK = "dark"
_PREFIX = "groundstation-"


class Tone(IntEnum):
    """What a piece of text or drawing is, for `styles_of`."""

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
    FADED = auto()
    HAND = auto()
    FORCE = auto()
    TARGET = auto()
    ROUTE = auto()
    OBSTACLE = auto()
    BESIDE = auto()
    EARTH = auto()
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


# Colour, ground, bold, italic.
_LOOKS: dict[Tone, tuple[str, str, bool, bool]] = {
    Tone.TEXT: ("text", "", False, False),
    Tone.STRONG: ("text", "", True, False),
    Tone.MUTED: ("muted", "", False, False),
    Tone.FAINT: ("faint", "", False, False),
    Tone.GRID: ("frame", "", False, False),
    Tone.OK: ("ok", "", False, False),
    Tone.WARN: ("warn", "", True, False),
    Tone.FAULT: ("on", "fault", True, False),
    Tone.VEHICLE: ("vehicle", "", True, False),
    Tone.TRAIL: ("trail", "", False, False),
    Tone.FADED: ("faded", "", False, False),
    Tone.HAND: ("hand", "", True, False),
    Tone.FORCE: ("force", "", True, False),
    Tone.TARGET: ("ok", "", True, False),
    Tone.ROUTE: ("ok", "", False, False),
    Tone.OBSTACLE: ("faint", "", False, False),
    Tone.BESIDE: ("text", "", False, False),
    Tone.EARTH: ("ground", "", False, False),
    Tone.STALE: ("muted", "", False, True),
    Tone.KEY: ("vehicle", "", True, False),
    Tone.CHIP: ("text", "frame", True, False),
    Tone.CHIP_OK: ("on", "ok", True, False),
    Tone.CHIP_HAND: ("on", "hand", True, False),
    Tone.CHIP_FAULT: ("on", "fault", True, False),
    Tone.SIMULATED: ("bright", "simulated", True, False),
    Tone.REAL: ("bright", "real", True, False),
    Tone.NOTE: ("muted", "", False, False),
    Tone.CAUTION: ("on", "warn", True, False),
    Tone.ALARM: ("on", "fault", True, False),
}

# The shapes that say the severity where there is no colour.
PRIORITIES = {Severity.INFO: "◇ ADVICE", Severity.WARNING: "▲ CAUTION", Severity.ALARM: "■ ALARM"}
MARKS = {Severity.INFO: " ", Severity.WARNING: "▲", Severity.ALARM: "■"}
TONES = {Severity.INFO: Tone.TEXT, Severity.WARNING: Tone.WARN, Severity.ALARM: Tone.FAULT}


@cache
def styles_of(theme: str) -> dict[Tone, Style]:
    """Return the styles of a theme, by its name among `THEMES` or `PALETTES`; another's are the dark one's."""
    palette = PALETTES.get(theme.removeprefix(_PREFIX), PALETTES[DARK])
    return {
        tone: Style(
            color=palette[color],
            bgcolor=palette[ground] if ground else None,
            bold=bold,
            italic=italic,
        )
        for tone, (color, ground, bold, italic) in _LOOKS.items()
    }


def _theme(name: str) -> Theme:
    palette = PALETTES[name]
    return Theme(
        name=_PREFIX + name,
        primary=palette["vehicle"],
        secondary=palette["hand"],
        accent=palette["force"],
        foreground=palette["text"],
        background=palette["ink"],
        surface=palette["pane"],
        panel=palette["frame"],
        success=palette["ok"],
        warning=palette["warn"],
        error=palette["fault"],
        dark=name != "light",
        variables=palette,
    )


THEMES = tuple(_theme(name) for name in PALETTES)
"""In the order in which the key goes round them."""
THEME = THEMES[0]
STYLES = styles_of(DARK)


def next_theme(name: str) -> str:
    """Return the theme after one."""
    names = [theme.name for theme in THEMES]
    return names[(names.index(name) + 1) % len(names)] if name in names else names[0]
