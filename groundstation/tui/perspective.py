"""Draws lines in space as a camera sees them: what is behind a body is not drawn, or only dotted. Pure NumPy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from groundstation.tui.camera import Camera, Solids, before
from groundstation.tui.canvas import Canvas, Dots, dots_of
from groundstation.tui.theme import Tone

Floats = NDArray[np.float64]

# Whether a dot is hidden is asked for one in so many.
_ASKED = 4
# Of lines that are seen through bodies, one dot in so many shows there.
_THROUGH = 4


class Lines(NamedTuple):
    """Lines of one look.

    Attributes:
        segments: World, m, shape (n, 2, 3).
        tone: Of their cells.
        gap: Only every so many dots.
        through: Seen through bodies, dotted.
        far: From this distance on they are dotted, and what is bright is dim, m.
    """

    segments: Floats
    tone: Tone
    gap: int = 1
    through: bool = False
    far: float = np.inf


def draw(canvas: Canvas, camera: Camera, solids: Solids, scene: list[Lines]) -> None:
    """Draw lines, later ones over earlier ones.

    Args:
        canvas: Drawn on; as large as the camera's picture.
        camera: Sees them.
        solids: Hide what is behind them.
        scene: What there is.
    """
    counts = [len(lines.segments) for lines in scene]
    if not sum(counts):
        return
    every = np.concatenate([lines.segments for lines in scene])
    tones = np.repeat(np.array([lines.tone for lines in scene], dtype=np.uint8), counts)
    gaps = np.repeat(np.array([lines.gap for lines in scene], dtype=np.intp), counts)
    through = np.repeat(np.array([lines.through for lines in scene], dtype=bool), counts)
    fars = np.repeat(np.array([lines.far for lines in scene]), counts)
    segments, seen = before(camera.seen(every))
    depth = segments[:, :, 2].mean(axis=1)
    distant = depth > fars
    gaps, tones = (
        np.where(distant, 2 * gaps, gaps),
        np.where(distant & (tones == Tone.BESIDE), np.uint8(Tone.OBSTACLE), tones),
    )
    segments, gaps, tones, through = segments[seen], gaps[seen], tones[seen], through[seen]
    x, y = camera.picture(segments)
    dots = dots_of(x, y, (canvas.width, canvas.height), gaps)
    hidden = _hidden(camera, solids, segments, dots)
    sparse = through[dots.line] & (np.arange(len(hidden)) % _THROUGH == 0)
    shown = ~hidden | sparse
    canvas.plot(dots.x[shown], dots.y[shown], tones[dots.line[shown]])


def visible(camera: Camera, solids: Solids, point: Floats) -> tuple[float, float] | None:
    """Return the dot of a point, or None where it is not in the picture or is hidden, by whatever can hide it."""
    x, y = camera.dots(point)
    inside = 0 <= x < camera.width and 0 <= y < camera.height
    if not inside or solids.hide(camera.place, point[None])[0]:
        return None
    return float(x), float(y)


def _hidden(camera: Camera, solids: Solids, segments: Floats, dots: Dots) -> NDArray[np.bool_]:
    """Say which dots are behind a body; of neighbours only one is asked about, the others are as it is."""
    few = slice(None, None, _ASKED)
    asked = Dots(dots.x[few], dots.y[few], dots.share[few], dots.line[few])
    hidden = solids.hide(camera.place, _places(camera, segments, asked))
    return np.repeat(hidden, _ASKED)[: len(dots.x)]


def _places(camera: Camera, segments: Floats, dots: Dots) -> Floats:
    """Return where in the world the dots of segments are, m; along a segment 1/depth goes evenly."""
    nearness = 1.0 / segments[:, :, 2]
    depth = 1.0 / (nearness[dots.line, 0] + dots.share * (nearness[dots.line, 1] - nearness[dots.line, 0]))
    across = (dots.x - (camera.width - 1) / 2) / camera.focal * depth
    down = (dots.y - (camera.height - 1) / 2) / camera.focal * depth
    return np.stack([across, down, depth], axis=1) @ camera.axes() + np.array(camera.place)
