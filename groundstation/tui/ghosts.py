"""The ghost of an earlier flight, hollow and dim, with the way it came: on the flat maps and from within."""

from __future__ import annotations

import numpy as np

from groundstation.training.ghost import ghost_at, ghost_trail
from groundstation.tui import wireframe
from groundstation.tui.canvas import Canvas
from groundstation.tui.frame import Frame
from groundstation.tui.perspective import Lines
from groundstation.tui.theme import Tone
from groundstation.tui.view import View

_TRAIL_S = 8.0
# A dot of its way so often, s: they stand where they are, while a line dotted by length would crawl.
_DOT_S = 0.1
# Half its size on a map, dots, and in space, m.
_DOTS, _SIZE_M = 3.0, 0.25
_NAME = "ghost"


def draw_ghost(canvas: Canvas, view: View, frame: Frame, *, named: bool) -> None:
    """Draw the ghost on a flat map as a hollow diamond, dotted where it came from.

    Args:
        canvas: Drawn on.
        view: What it shows.
        frame: What there is.
        named: Say what it is.
    """
    track, elapsed = frame.run.ghost, _elapsed(frame)
    if track is None or ghost_at(track, elapsed) is None:
        return
    dots = view.dots(np.array(ghost_trail(track, elapsed, _TRAIL_S)))
    shares = np.linspace(0.0, 1.0, max(round(track.every_s / _DOT_S), 1), endpoint=False)
    across, down = ((axis[:-1, None] + np.diff(axis)[:, None] * shares).ravel() for axis in dots)
    canvas.plot(across, down, Tone.MUTED)
    x, y = (float(axis[-1]) for axis in dots)
    canvas.line([x - _DOTS, x, x + _DOTS, x, x - _DOTS], [y, y - _DOTS, y, y + _DOTS, y], Tone.MUTED)
    if named:
        canvas.letters(int(x / 2) - len(_NAME) // 2, int((y + _DOTS) / 4) + 1, _NAME, Tone.MUTED)


def ghost_lines(frame: Frame) -> list[Lines]:
    """Return the ghost as the views from within show it."""
    track, elapsed = frame.run.ghost, _elapsed(frame)
    if track is None or (here := ghost_at(track, elapsed)) is None:
        return []
    trail = np.array(ghost_trail(track, elapsed, _TRAIL_S))
    middle = np.array(here)
    body = np.concatenate([wireframe.diamond(middle, _SIZE_M), wireframe.level_circle(middle, _SIZE_M)])
    return [Lines(wireframe.path(trail), Tone.MUTED, 4), Lines(body, Tone.MUTED)]


def _elapsed(frame: Frame) -> float:
    return frame.guide.elapsed if frame.guide is not None else 0.0
