"""The map from above as pure drawing: obstacles, route, target, trail, vehicle, hand and leash.

North is up, east to the right; dots are square, so one scale holds for both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.training.mission import Mission
from groundstation.tui.canvas import Canvas
from groundstation.tui.theme import Tone
from sim.scenario import Box, Cylinder, Obstacle, Sphere

Floats = NDArray[np.float64]

# Free flight shows at least this far around the start, m.
LEAST_HALF_M = 4.0
MARGIN_M = 1.0
_SCALES = tuple(
    step * 10.0**power
    for power in range(-2, 4)
    for step in (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.4, 8.0)
)
_RULERS = tuple(step * 10.0**power for power in range(-1, 5) for step in (1.0, 2.0, 5.0))
# An arrowhead of length 1.6 with a notched tail: x forward, y left.
_ARROW = np.array(
    [(x, y) for x in np.arange(-0.6, 1.01, 0.05) for y in np.arange(-0.6, 0.61, 0.05)
     if abs(y) <= (1.0 - x) * 0.35 and (x >= -0.25 or abs(y) >= (-0.25 - x) * 1.1)]
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class View:
    """Which part of the world a canvas shows.

    Attributes:
        east, north: The world's point in its middle, m.
        scale: Metres a dot.
        width, height: Dots.
    """

    east: float
    north: float
    scale: float
    width: int
    height: int

    def x(self, east: Floats | float) -> Floats:
        """Return dots from the left."""
        return np.asarray((east - self.east) / self.scale + (self.width - 1) / 2)

    def y(self, north: Floats | float) -> Floats:
        """Return dots from the top."""
        return np.asarray((self.north - north) / self.scale + (self.height - 1) / 2)

    def holds(self, points: Sequence[tuple[float, float]]) -> bool:
        """Say whether all points are within the picture, a little off its edge."""
        across, up = 0.5 * self.scale * (self.width - 6), 0.5 * self.scale * (self.height - 6)
        return all(
            abs(east - self.east) <= across and abs(north - self.north) <= up for east, north in points
        )


def framing(mission: Mission | None, points: Sequence[tuple[float, float]], width: int, height: int) -> View:
    """Return the view that shows the start, the mission and further points, at a scale from a fixed ladder.

    Args:
        mission: What is flown, or None.
        points: Further world points [east, north], m, that shall be seen.
        width: Dots across.
        height: Dots down.
    """
    seen = [(-LEAST_HALF_M / 2, 0.0), (LEAST_HALF_M / 2, 0.0), *points]
    if mission is not None:
        seen += [(point[0], point[1]) for point in mission.route]
        seen += [(mission.target.position[0], mission.target.position[1])] if mission.target else []
        for obstacle in mission.obstacle:
            reach = _reach(obstacle)
            east, north, _ = obstacle.center
            seen += [(east - reach, north - reach), (east + reach, north + reach)]
    easts, norths = [point[0] for point in seen], [point[1] for point in seen]
    spans = (max(easts) - min(easts) + 2 * MARGIN_M, max(norths) - min(norths) + 2 * MARGIN_M)
    least = max(spans[0] / max(width - 6, 1), spans[1] / max(height - 6, 1))
    scale = next((scale for scale in _SCALES if scale >= least), _SCALES[-1])
    return View((max(easts) + min(easts)) / 2, (max(norths) + min(norths)) / 2, scale, width, height)


def draw_world(canvas: Canvas, view: View, mission: Mission | None, altitude: float) -> None:
    """Draw what stands still: grid, start, obstacles, route and target.

    Args:
        canvas: Drawn on.
        view: What it shows.
        mission: What is flown, or None.
        altitude: The vehicle's, m: obstacles that reach it are drawn solid, others as outlines.
    """
    _grid(canvas, view)
    _cross(canvas, float(view.x(0.0)), float(view.y(0.0)), 2, Tone.MUTED)
    if mission is None:
        return
    for obstacle in mission.obstacle:
        _obstacle(canvas, view, obstacle, solid=beside(obstacle, altitude))
    if mission.route:
        way = np.array([(0.0, 0.0), *((east, north) for east, north, _ in mission.route)])
        canvas.line(view.x(way[:, 0]), view.y(way[:, 1]), Tone.ROUTE, gap=4)
    if mission.target is not None:
        east, north, _ = mission.target.position
        if mission.route:
            last = mission.route[-1]
            canvas.line(
                view.x(np.array([last[0], east])), view.y(np.array([last[1], north])), Tone.ROUTE, gap=4
            )
        _ring(canvas, view, (east, north, max(mission.target.radius, 4.0 * view.scale)), Tone.TARGET)
        _cross(canvas, float(view.x(east)), float(view.y(north)), 1, Tone.TARGET)


def beside(obstacle: Obstacle, altitude: float) -> bool:
    """Say whether an obstacle is at the vehicle's altitude, a margin of half a metre included."""
    margin = 0.5
    if isinstance(obstacle, Sphere):
        half = obstacle.radius
    elif isinstance(obstacle, Cylinder):
        half = obstacle.height / 2
    else:
        half = obstacle.size[2] / 2
    return abs(altitude - obstacle.center[2]) <= half + margin


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
    if not all(map(math.isfinite, (east, north, yaw))):
        return
    cosine, sine = math.cos(yaw), math.sin(yaw)
    size = max(4.5, min(8.0, view.height / 14))
    forward, left = size * _ARROW[:, 0], size * _ARROW[:, 1]
    x = view.x(east) + cosine * forward - sine * left
    y = view.y(north) - (sine * forward + cosine * left)
    canvas.plot(x, y, Tone.VEHICLE)


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
    _ring(canvas, view, (*place, leash), Tone.WARN if taut else Tone.FAINT, gap=3)
    ends = np.array([place, wanted])
    canvas.line(view.x(ends[:, 0]), view.y(ends[:, 1]), tone, gap=2)
    x, y = float(view.x(wanted[0])), float(view.y(wanted[1]))
    canvas.line([x - 2, x + 2, x + 2, x - 2, x - 2], [y - 2, y - 2, y + 2, y + 2, y - 2], tone)


def draw_legend(canvas: Canvas, view: View) -> None:
    """Write the scale and where north is."""
    room = canvas.columns // 4
    length = max((ruler for ruler in _RULERS if ruler / view.scale / 2 <= room), default=_RULERS[0])
    cells = max(round(length / view.scale / 2), 2)
    canvas.letters(1, canvas.rows - 1, f"├{'─' * (cells - 2)}┤ {length:g} m", Tone.MUTED)
    canvas.letters(canvas.columns - 4, 0, "N ↑", Tone.MUTED)


def label_obstacles(canvas: Canvas, view: View, mission: Mission | None) -> None:
    """Write the obstacles' names under them."""
    for obstacle in mission.obstacle if mission else ():
        column = int(view.x(obstacle.center[0]) / 2) - len(obstacle.name) // 2
        row = int((view.y(obstacle.center[1]) + _reach(obstacle) / view.scale) / 4) + 1
        canvas.letters(column, row, obstacle.name, Tone.MUTED)


def _reach(obstacle: Obstacle) -> float:
    """Return how far an obstacle reaches from its centre in the plane, m."""
    return (
        math.hypot(obstacle.size[0], obstacle.size[1]) / 2 if isinstance(obstacle, Box) else obstacle.radius
    )


def _grid(canvas: Canvas, view: View) -> None:
    """Dots on whole steps of a ruler, far enough apart to stay faint."""
    step = next((ruler for ruler in _RULERS if ruler / view.scale >= 10), _RULERS[-1])
    half_east, half_north = view.width * view.scale / 2, view.height * view.scale / 2
    easts = np.arange(math.ceil((view.east - half_east) / step), (view.east + half_east) / step + 1) * step
    norths = (
        np.arange(math.ceil((view.north - half_north) / step), (view.north + half_north) / step + 1) * step
    )
    grid_east, grid_north = np.meshgrid(easts, norths)
    canvas.plot(view.x(grid_east.ravel()), view.y(grid_north.ravel()), Tone.GRID)


def _obstacle(canvas: Canvas, view: View, obstacle: Obstacle, *, solid: bool) -> None:
    tone = Tone.BESIDE if solid else Tone.OBSTACLE
    east, north, _ = obstacle.center
    reach = _reach(obstacle)
    if solid:
        steps = np.arange(-reach, reach + view.scale, view.scale)
        x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
        inside = _inside(obstacle, x, y)
        columns, rows = np.rint(view.x(east + x[inside])), np.rint(view.y(north + y[inside]))
        hatched = (columns + rows) % 2 == 0
        canvas.plot(columns[hatched], rows[hatched], tone)
    if isinstance(obstacle, Box):
        yaw, (length, width, _) = math.radians(obstacle.yaw_deg), obstacle.size
        corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)]) * (length / 2, width / 2)
        x = east + math.cos(yaw) * corners[:, 0] - math.sin(yaw) * corners[:, 1]
        y = north + math.sin(yaw) * corners[:, 0] + math.cos(yaw) * corners[:, 1]
        canvas.line(view.x(x), view.y(y), tone)
    else:
        _ring(canvas, view, (east, north, obstacle.radius), tone)


def _inside(obstacle: Obstacle, x: Floats, y: Floats) -> NDArray[np.bool_]:
    """Say which points, relative to its centre, are within an obstacle's outline."""
    if not isinstance(obstacle, Box):
        return x**2 + y**2 <= obstacle.radius**2
    yaw = math.radians(obstacle.yaw_deg)
    along = math.cos(yaw) * x + math.sin(yaw) * y
    across = math.cos(yaw) * y - math.sin(yaw) * x
    return (abs(along) <= obstacle.size[0] / 2) & (abs(across) <= obstacle.size[1] / 2)


def _ring(canvas: Canvas, view: View, circle: tuple[float, float, float], tone: Tone, gap: int = 1) -> None:
    """Draw a circle of (east, north, radius), m."""
    east, north, radius = circle
    count = int(min(max(math.tau * radius / view.scale, 12), 2000))
    angles = np.arange(0, count, gap) * (math.tau / count)
    canvas.plot(view.x(east + radius * np.cos(angles)), view.y(north + radius * np.sin(angles)), tone)


def _cross(canvas: Canvas, x: float, y: float, arm: int, tone: Tone) -> None:
    canvas.line([x - arm, x + arm], [y, y], tone)
    canvas.line([x, x], [y - arm, y + arm], tone)
