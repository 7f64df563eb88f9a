"""`groundstation missions show`: a mission in words, and its map as the flight's screen draws it."""

from __future__ import annotations

import argparse

from rich.console import Console
from rich.text import Text

from groundstation.training.briefing import briefing, par_words
from groundstation.training.mission import Mission, find_mission, load_mission
from groundstation.tui.canvas import Canvas
from groundstation.tui.rows import Row
from groundstation.tui.scene import draw_legend, draw_world, label_obstacles
from groundstation.tui.theme import Tone
from groundstation.tui.view import framing

_WIDEST, _LOWEST, _HIGHEST = 100, 8, 22
# More names than these hide the map.
_NAMED = 10
# In the terminal's own colours, for its ground is not known here.
_COLOURS = {
    Tone.ROUTE: "green",
    Tone.TARGET: "bold green",
    Tone.OBSTACLE: "bright_black",
    Tone.MUTED: "bright_black",
    Tone.GRID: "bright_black",
}


def run(asked: argparse.Namespace) -> int:
    """Print the briefing and the map; return the exit code."""
    path = find_mission(asked.mission)
    mission = load_mission(path)
    console = Console(highlight=False)
    width = min(console.width, _WIDEST)
    for line in briefing(mission, par_words(mission, path), width):
        console.print(Text(line))
    console.print(Text(f"fly it   groundstation --sim --mission {asked.mission}\n"))
    for row in chart(mission, width):
        console.print(Text.assemble(*((text, _COLOURS.get(tone, "")) for text, tone in row)))
    return 0


def chart(mission: Mission, columns: int) -> list[Row]:
    """Return the map of a mission from above, north up, in no more rows than its scale needs."""
    views = [framing(mission, (), 2 * columns, 4 * rows) for rows in range(_LOWEST, _HIGHEST + 1)]
    view = next(view for view in views if view.scale == views[-1].scale)
    canvas = Canvas(columns, view.height // 4)
    draw_world(canvas, view, mission, mission.takeoff_altitude_m)
    if len(mission.obstacle) <= _NAMED:
        label_obstacles(canvas, view, mission)
    draw_legend(canvas, view)
    return canvas.to_rows()
