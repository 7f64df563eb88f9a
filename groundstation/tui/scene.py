"""The map from above as pure drawing, what stands still: obstacles, fence, route, target. For the rest see `moving`.

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
from sim.environment.shapes import extent, half_height, primitives, reach
from sim.scenario import Box, Obstacle, Pad, Primitive

Floats = NDArray[np.float64]

# Free flight shows at least this far around the start, m.
LEAST_HALF_M = 4.0
MARGIN_M = 1.0
# What the pilot calls the fence where it guards.
FENCE = "fence"
_SCALES = tuple(
    step * 10.0**power
    for power in range(-2, 4)
    for step in (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.4, 8.0)
)
_RULERS = tuple(step * 10.0**power for power in range(-1, 5) for step in (1.0, 2.0, 5.0))


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
        seen += [corner[:2] for obstacle in mission.obstacle for corner in extent(obstacle)]
        for pad in mission.pad:
            east, north, _ = pad.position
            seen += [(east - pad.radius, north - pad.radius), (east + pad.radius, north + pad.radius)]
    easts, norths = [point[0] for point in seen], [point[1] for point in seen]
    spans = (max(easts) - min(easts) + 2 * MARGIN_M, max(norths) - min(norths) + 2 * MARGIN_M)
    least = max(spans[0] / max(width - 6, 1), spans[1] / max(height - 6, 1))
    scale = next((scale for scale in _SCALES if scale >= least), _SCALES[-1])
    return View((max(easts) + min(easts)) / 2, (max(norths) + min(norths)) / 2, scale, width, height)


def draw_world(
    canvas: Canvas, view: View, mission: Mission | None, altitude: float, fence: float = 0.0
) -> None:
    """Draw what stands still: grid, start, fence, pads, obstacles, route and target.

    Args:
        canvas: Drawn on.
        view: What it shows.
        mission: What is flown, or None.
        altitude: The vehicle's, m: what reaches it is drawn solid, the rest as outlines; so a gate's posts are solid
            and its beams are lines.
        fence: Its radius around the start, m; 0 for none.
    """
    _grid(canvas, view)
    _cross(canvas, float(view.x(0.0)), float(view.y(0.0)), 2, Tone.MUTED)
    if fence > 0.0:
        ring(canvas, view, (0.0, 0.0, fence), Tone.OBSTACLE, gap=2)
    if mission is None:
        return
    for pad in mission.pad:
        _pad(canvas, view, pad)
    for solid, part in sorted(
        ((beside(part, altitude), part) for part in _parts(mission)), key=lambda each: each[0]
    ):
        if solid:
            _hatch(canvas, view, part)
        _outline(canvas, view, part, Tone.BESIDE if solid else Tone.OBSTACLE)
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
        ring(canvas, view, (east, north, max(mission.target.radius, 4.0 * view.scale)), Tone.TARGET)
        _cross(canvas, float(view.x(east)), float(view.y(north)), 1, Tone.TARGET)


def draw_guarded(canvas: Canvas, view: View, mission: Mission | None, name: str, fence: float = 0.0) -> None:
    """Draw what the guard keeps away from so that it stands out: an obstacle with its name, or the fence.

    Args:
        canvas: Drawn on.
        view: What it shows.
        mission: What is flown, or None.
        name: As the pilot says it; what has no place on the map is not drawn.
        fence: Its radius around the start, m; 0 for none.
    """
    guarded = [obstacle for obstacle in mission.obstacle if obstacle.name == name] if mission else []
    for obstacle in guarded:
        for part in primitives(obstacle):
            _outline(canvas, view, part, Tone.WARN)
        _label(canvas, view, obstacle, Tone.WARN)
    if name == FENCE and fence > 0.0 and not guarded:
        ring(canvas, view, (0.0, 0.0, fence), Tone.WARN)


def beside(part: Primitive, altitude: float) -> bool:
    """Say whether a part of an obstacle is at the vehicle's altitude, a margin of half a metre included."""
    return abs(altitude - part.center[2]) <= half_height(part) + 0.5


def levels(mission: Mission | None, altitude: float) -> tuple[bool, ...]:
    """Return for each part of the obstacles whether it is at the vehicle's altitude: it decides how the map looks."""
    return tuple(beside(part, altitude) for part in _parts(mission)) if mission else ()


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
        _label(canvas, view, obstacle, Tone.MUTED)


def ring(canvas: Canvas, view: View, circle: tuple[float, float, float], tone: Tone, gap: int = 1) -> None:
    """Draw a circle of (east, north, radius), m; of its dots only every so many, for a dotted one."""
    east, north, radius = circle
    count = int(min(max(math.tau * radius / view.scale, 12), 2000))
    angles = np.arange(0, count, gap) * (math.tau / count)
    canvas.plot(view.x(east + radius * np.cos(angles)), view.y(north + radius * np.sin(angles)), tone)


def _label(canvas: Canvas, view: View, obstacle: Obstacle, tone: Tone) -> None:
    (west, south, _), (east, _, _) = extent(obstacle)
    column = int(view.x(0.5 * (west + east)) / 2) - len(obstacle.name) // 2
    canvas.letters(column, int(view.y(south) / 4) + 1, obstacle.name, tone)


def _parts(mission: Mission) -> list[Primitive]:
    return [part for obstacle in mission.obstacle for part in primitives(obstacle)]


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


def _hatch(canvas: Canvas, view: View, part: Primitive) -> None:
    """Fill a part with dots."""
    east, north, _ = part.center
    steps = np.arange(-reach(part), reach(part) + view.scale, view.scale)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    inside = _inside(part, x, y)
    columns, rows = np.rint(view.x(east + x[inside])), np.rint(view.y(north + y[inside]))
    hatched = (columns + rows) % 2 == 0
    canvas.plot(columns[hatched], rows[hatched], Tone.BESIDE)


def _outline(canvas: Canvas, view: View, part: Primitive, tone: Tone) -> None:
    east, north, _ = part.center
    if not isinstance(part, Box):
        ring(canvas, view, (east, north, part.radius), tone)
        return
    yaw, (length, width, _) = math.radians(part.yaw_deg), part.size
    corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)]) * (length / 2, width / 2)
    x = east + math.cos(yaw) * corners[:, 0] - math.sin(yaw) * corners[:, 1]
    y = north + math.sin(yaw) * corners[:, 0] + math.cos(yaw) * corners[:, 1]
    canvas.line(view.x(x), view.y(y), tone)


def _inside(part: Primitive, x: Floats, y: Floats) -> NDArray[np.bool_]:
    """Say which points, relative to its centre, are within a part's outline."""
    if not isinstance(part, Box):
        return x**2 + y**2 <= part.radius**2
    yaw = math.radians(part.yaw_deg)
    along = math.cos(yaw) * x + math.sin(yaw) * y
    across = math.cos(yaw) * y - math.sin(yaw) * x
    return (abs(along) <= part.size[0] / 2) & (abs(across) <= part.size[1] / 2)


def _pad(canvas: Canvas, view: View, pad: Pad) -> None:
    east, north, _ = pad.position
    ring(canvas, view, (east, north, max(pad.radius, 3.0 * view.scale)), Tone.MUTED)
    _cross(canvas, float(view.x(east)), float(view.y(north)), 1, Tone.MUTED)


def _cross(canvas: Canvas, x: float, y: float, arm: int, tone: Tone) -> None:
    canvas.line([x - arm, x + arm], [y, y], tone)
    canvas.line([x, x], [y - arm, y + arm], tone)
