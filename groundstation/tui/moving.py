"""A flat map as pure drawing, what moves: way flown, vehicle, forecast, hand, echoes. World points are m, ENU."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from groundstation.messages import RING_SECTORS
from groundstation.tui.canvas import Canvas
from groundstation.tui.scene import ring
from groundstation.tui.theme import Tone
from groundstation.tui.view import TOP, Floats, View

# East, north and up, m, and yaw counter-clockwise from east, rad.
Pose = tuple[float, float, float, float]
Place = tuple[float, float, float]

# The way flown is bright while it is this young, then dimmer, then only every other dot, s.
FRESH_S, FADED_S = 6.0, 25.0
# An arrowhead of length 1.6 with a notched tail: x forward, y left. Its outline, and the dots within.
_OUTLINE = np.array([(1.0, 0.0), (-0.6, 0.56), (-0.25, 0.0), (-0.6, -0.56), (1.0, 0.0)])
_ARROW = np.array(
    [(x, y) for x in np.arange(-0.6, 1.01, 0.05) for y in np.arange(-0.6, 0.61, 0.05)
     if abs(y) <= (1.0 - x) * 0.35 and (x >= -0.25 or abs(y) >= (-0.25 - x) * 1.1)]
)  # fmt: skip
# Places nearer to each other are not told apart, dots.
_APART = 2.0
_SECTORS = np.arange(RING_SECTORS) * (math.tau / RING_SECTORS)


def tones_by_age(age: Floats) -> np.ndarray[tuple[int], np.dtype[np.uint8]]:
    """Return the tone of each point of the way flown by its age, s."""
    tones = np.where(age < FADED_S, np.uint8(Tone.TRAIL), np.uint8(Tone.FADED))
    return np.where(age < FRESH_S, np.uint8(Tone.VEHICLE), tones)


def draw_trail(canvas: Canvas, view: View, points: Floats, now: float) -> None:
    """Draw the way flown: the older, the dimmer and the sparser.

    Args:
        canvas: Drawn on.
        view: What it shows.
        points: East, north, up, m, and time, s, shape (n, 4).
        now: s.
    """
    if not len(points):
        return
    x, y = view.dots(points)
    age = now - points[:, 3]
    shown = (age < FADED_S) | (np.arange(len(points)) % 2 == 0)
    canvas.plot(x[shown], y[shown], tones_by_age(age[shown]))


def draw_vehicle(canvas: Canvas, view: View, seen: Pose) -> None:
    """Draw the vehicle as an arrowhead that is always well seen."""
    if all(map(math.isfinite, seen)):
        x, y = _turned(view, _ARROW, seen)
        canvas.plot(x, y, Tone.VEHICLE)


def draw_predicted(canvas: Canvas, view: View, seen: Pose, predicted: Pose, stop: Place) -> None:
    """Draw where the vehicle will be as a hollow arrowhead, and where it can stop as a cross: if that is elsewhere.

    Args:
        canvas: Drawn on.
        view: What it shows.
        seen: Where the vehicle was last seen.
        predicted: Where it will be when what is sent now reaches it.
        stop: Where it comes to rest with a centred handle.
    """
    if not all(map(math.isfinite, (*seen, *predicted, *stop))):
        return
    now, then, end = view.plane.flat(seen), view.plane.flat(predicted), view.plane.flat(stop)
    if math.dist(now, then) >= _APART * view.scale:
        canvas.line(*_turned(view, _OUTLINE, predicted), Tone.VEHICLE)
    if math.dist(now, end) < (_APART + _size(view)) * view.scale:
        return
    canvas.line(view.x(np.array([then[0], end[0]])), view.y(np.array([then[1], end[1]])), Tone.TRAIL, gap=2)
    x, y = float(view.x(end[0])), float(view.y(end[1]))
    steps = np.arange(-2.0, 3.0)
    canvas.plot(np.tile(x + steps, 2), np.concatenate([y + steps, y - steps]), Tone.VEHICLE)


def draw_echoes(canvas: Canvas, view: View, seen: Pose, distances: Sequence[float], tone: Tone) -> None:
    """Draw what the vehicle's own distance sensors see on its level.

    Args:
        canvas: Drawn on.
        view: What it shows.
        seen: Where the vehicle was last seen.
        distances: By sectors, counter-clockwise from forward, m; what is not finite is nothing.
        tone: Of the points.
    """
    canvas.plot(*view.dots(echoes(seen, distances)), tone)


def echoes(seen: Pose, distances: Sequence[float]) -> Floats:
    """Return the places that the distance sensors see, world, m, shape (n, 3); NaN for none."""
    east, north, up, yaw = seen
    reach = np.where(np.isfinite(distances), distances, np.nan)
    angles = yaw + _SECTORS
    return np.stack(
        [east + reach * np.cos(angles), north + reach * np.sin(angles), np.full(len(reach), up)], axis=1
    )


def draw_hand(canvas: Canvas, view: View, place: Place, wanted: Place, leash: float, *, taut: bool) -> None:
    """Draw where the hand wants the vehicle, the line to it, and the leash around the vehicle.

    Args:
        canvas: Drawn on.
        view: What it shows.
        place: The vehicle.
        wanted: p_h.
        leash: Its length, m.
        taut: The leash holds p_h back.
    """
    if not all(map(math.isfinite, (*place, *wanted))):
        return
    tone = Tone.WARN if taut else Tone.HAND
    ring(canvas, view, (*view.plane.flat(place), leash), Tone.WARN if taut else Tone.FAINT, gap=3)
    ends = np.array([place, wanted])
    canvas.line(*view.dots(ends), tone, gap=2)
    x, y = (float(axis[1]) for axis in view.dots(ends))
    canvas.line([x - 2, x + 2, x + 2, x - 2, x - 2], [y - 2, y - 2, y + 2, y + 2, y - 2], tone)


def _size(view: View) -> float:
    """Return the length of an arrowhead from its middle to its tip, dots."""
    return max(4.5, min(8.0, view.height / 14))


def _turned(view: View, shape: Floats, pose: Pose) -> tuple[Floats, Floats]:
    """Return the dots of a shape, given forward and left in lengths of an arrowhead, at a pose.

    From the side it is as short as it looks from there, and half as high as it is wide from above.
    """
    forward, left = _size(view) * shape[:, 0], _size(view) * shape[:, 1]
    cosine, sine = math.cos(pose[3]), math.sin(pose[3])
    middle = view.plane.flat(pose)
    x, y = view.x(middle[0]), view.y(middle[1])
    if view.plane is TOP:
        return x + cosine * forward - sine * left, y - (sine * forward + cosine * left)
    along = (cosine, sine)[view.plane.across]
    return x + along * forward + 0.35 * (1.0 - abs(along)) * left, y - 0.5 * left
