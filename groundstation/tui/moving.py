"""The map from above as pure drawing, what moves: way flown, vehicle, where it will be, hand, echoes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from groundstation.messages import RING_SECTORS
from groundstation.tui.canvas import Canvas
from groundstation.tui.scene import Floats, View, ring
from groundstation.tui.theme import Tone

# East and north, m, and yaw counter-clockwise from east, rad.
Pose = tuple[float, float, float]

# An arrowhead of length 1.6 with a notched tail: x forward, y left. Its outline, and the dots within.
_OUTLINE = np.array([(1.0, 0.0), (-0.6, 0.56), (-0.25, 0.0), (-0.6, -0.56), (1.0, 0.0)])
_ARROW = np.array(
    [(x, y) for x in np.arange(-0.6, 1.01, 0.05) for y in np.arange(-0.6, 0.61, 0.05)
     if abs(y) <= (1.0 - x) * 0.35 and (x >= -0.25 or abs(y) >= (-0.25 - x) * 1.1)]
)  # fmt: skip
# Places nearer to each other are not told apart, dots.
_APART = 2.0
_SECTORS = np.arange(RING_SECTORS) * (math.tau / RING_SECTORS)


def draw_trail(canvas: Canvas, view: View, points: Floats) -> None:
    """Draw the way flown.

    Args:
        canvas: Drawn on.
        view: What it shows.
        points: East and north, m, shape (n, 2).
    """
    if len(points):
        canvas.plot(view.x(points[:, 0]), view.y(points[:, 1]), Tone.TRAIL)


def draw_vehicle(canvas: Canvas, view: View, east: float, north: float, yaw: float) -> None:
    """Draw the vehicle as an arrowhead that is always well seen; yaw counter-clockwise from east, rad."""
    if all(map(math.isfinite, (east, north, yaw))):
        canvas.plot(*_turned(view, _ARROW, (east, north, yaw)), Tone.VEHICLE)


def draw_predicted(
    canvas: Canvas, view: View, seen: Pose, predicted: Pose, stop: tuple[float, float]
) -> None:
    """Draw where the vehicle will be as a hollow arrowhead, and where it can stop as a cross: if that is elsewhere.

    Args:
        canvas: Drawn on.
        view: What it shows.
        seen: Where the vehicle was last seen, m and rad.
        predicted: Where it will be when what is sent now reaches it.
        stop: Where it comes to rest with a centred handle, m.
    """
    if not all(map(math.isfinite, (*seen, *predicted, *stop))):
        return
    if math.dist(seen[:2], predicted[:2]) >= _APART * view.scale:
        canvas.line(*_turned(view, _OUTLINE, predicted), Tone.VEHICLE)
    if math.dist(seen[:2], stop) < (_APART + _size(view)) * view.scale:
        return
    ends = np.array([predicted[:2], stop])
    canvas.line(view.x(ends[:, 0]), view.y(ends[:, 1]), Tone.TRAIL, gap=2)
    x, y = float(view.x(stop[0])), float(view.y(stop[1]))
    for side in (2, -2):
        canvas.line([x - 2, x + 2], [y - side, y + side], Tone.VEHICLE)


def draw_echoes(canvas: Canvas, view: View, seen: Pose, distances: Sequence[float], tone: Tone) -> None:
    """Draw what the vehicle's own distance sensors see on its level.

    Args:
        canvas: Drawn on.
        view: What it shows.
        seen: Where the vehicle was last seen, m and rad.
        distances: By sectors, counter-clockwise from forward, m; what is not finite is nothing.
        tone: Of the points.
    """
    east, north, yaw = seen
    ring_m = np.where(np.isfinite(distances), distances, np.nan)
    x, y = east + ring_m * np.cos(yaw + _SECTORS), north + ring_m * np.sin(yaw + _SECTORS)
    canvas.plot(view.x(x), view.y(y), tone)


def draw_hand(
    canvas: Canvas,
    view: View,
    place: tuple[float, float],
    wanted: tuple[float, float],
    leash: float,
    *,
    taut: bool,
) -> None:
    """Draw where the hand wants the vehicle, the line to it, and the leash around the vehicle.

    Args:
        canvas: Drawn on.
        view: What it shows.
        place: The vehicle, m.
        wanted: p_h, m.
        leash: Its length, m.
        taut: The leash holds p_h back.
    """
    if not all(map(math.isfinite, (*place, *wanted))):
        return
    tone = Tone.WARN if taut else Tone.HAND
    ring(canvas, view, (*place, leash), Tone.WARN if taut else Tone.FAINT, gap=3)
    ends = np.array([place, wanted])
    canvas.line(view.x(ends[:, 0]), view.y(ends[:, 1]), tone, gap=2)
    x, y = float(view.x(wanted[0])), float(view.y(wanted[1]))
    canvas.line([x - 2, x + 2, x + 2, x - 2, x - 2], [y - 2, y - 2, y + 2, y + 2, y - 2], tone)


def _size(view: View) -> float:
    """Return the length of an arrowhead from its middle to its tip, dots."""
    return max(4.5, min(8.0, view.height / 14))


def _turned(view: View, shape: Floats, pose: Pose) -> tuple[Floats, Floats]:
    """Return the dots of a shape, given forward and left in lengths of an arrowhead, at a pose."""
    east, north, yaw = pose
    cosine, sine = math.cos(yaw), math.sin(yaw)
    forward, left = _size(view) * shape[:, 0], _size(view) * shape[:, 1]
    x = view.x(east) + cosine * forward - sine * left
    return x, view.y(north) - (sine * forward + cosine * left)
