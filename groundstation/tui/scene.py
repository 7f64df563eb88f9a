"""A flat map as pure drawing, what stands still. `goals` has what the mission leads to, `moving` the rest."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from groundstation.training.mission import Fence, Mission
from groundstation.tui.canvas import Canvas
from groundstation.tui.theme import Tone
from groundstation.tui.view import TOP, Floats, View
from sim.environment.shapes import extent, half_height, primitives, reach
from sim.scenario import Box, Gate, Obstacle, Pad, Primitive, Sphere

# What the pilot calls the fence where it guards.
FENCE = "fence"
NO_FENCE = Fence(floor=0.0)
_RULERS = tuple(step * 10.0**power for power in range(-1, 5) for step in (1.0, 2.0, 5.0))
# A part this near to the vehicle in the direction that is not seen counts as beside it, m.
_BESIDE_M = 0.5
_SIDES = 32


def draw_world(
    canvas: Canvas, view: View, mission: Mission | None, depth: float, fence: Fence = NO_FENCE
) -> None:
    """Draw what stands still: grid, start, fence, pads and obstacles.

    Args:
        canvas: Drawn on.
        view: What it shows.
        mission: What is flown, or None.
        depth: Where the vehicle is in the direction that is not seen, from above its altitude, m: what reaches it is
            drawn solid, the rest as outlines; so a gate's posts are solid and its beams are lines.
        fence: Where the hand may take the vehicle.
    """
    _grid(canvas, view)
    if view.plane is not TOP:
        level = float(view.y(0.0))
        canvas.line([0, canvas.width - 1], [level, level], Tone.EARTH)
    draw_fence(canvas, view, fence, Tone.OBSTACLE)
    cross(canvas, float(view.x(0.0)), float(view.y(0.0)), 2, Tone.MUTED)
    if mission is None:
        return
    for pad in mission.pad:
        _pad(canvas, view, pad)
    for solid, part in sorted(
        ((beside(part, depth, view), part) for part in _parts(mission)), key=lambda each: each[0]
    ):
        outline = silhouette(part, view)
        if solid:
            _hatch(canvas, view, outline)
        canvas.line(view.x(outline[:, 0]), view.y(outline[:, 1]), Tone.BESIDE if solid else Tone.OBSTACLE)


def draw_fence(canvas: Canvas, view: View, fence: Fence, tone: Tone) -> None:
    """Draw how far and how high the hand may take the vehicle, dotted."""
    radius, gap = fence.radius, 1 if tone is Tone.WARN else 2
    if view.plane is TOP:
        if radius > 0.0:
            ring(canvas, view, (0.0, 0.0, radius), tone, gap=gap)
        return
    end = radius if radius > 0.0 else 1e4
    for level in (fence.floor, fence.ceiling):
        if level > 0.0:
            canvas.line(view.x(np.array([-end, end])), view.y(np.array([level, level])), tone, gap=2 * gap)
    if radius > 0.0:
        top = np.array([fence.floor, fence.ceiling or 1e4])
        for side in (-radius, radius):
            canvas.line(view.x(np.array([side, side])), view.y(top), tone, gap=gap)


def draw_guarded(
    canvas: Canvas, view: View, mission: Mission | None, name: str, fence: Fence = NO_FENCE
) -> None:
    """Draw what the guard keeps away from so that it stands out: an obstacle with its name, or the fence.

    Args:
        canvas: Drawn on.
        view: What it shows.
        mission: What is flown, or None.
        name: As the pilot says it; what has no place on the map is not drawn.
        fence: Where the hand may take the vehicle.
    """
    guarded = [obstacle for obstacle in mission.obstacle if obstacle.name == name] if mission else []
    for obstacle in guarded:
        for part in primitives(obstacle):
            outline = silhouette(part, view)
            canvas.line(view.x(outline[:, 0]), view.y(outline[:, 1]), Tone.WARN)
        _label(canvas, view, obstacle.name, obstacle, Tone.WARN)
    if name == FENCE and not guarded:
        draw_fence(canvas, view, fence, Tone.WARN)


def beside(part: Primitive, depth: float, view: View) -> bool:
    """Say whether a part of an obstacle reaches a depth, a margin of half a metre included."""
    size = half_height(part) if view.plane is TOP else reach(part)
    return abs(depth - part.center[view.plane.depth]) <= size + _BESIDE_M


def levels(mission: Mission | None, depth: float, view: View) -> tuple[bool, ...]:
    """Return for each part of the obstacles whether it is beside the vehicle: it decides how the map looks."""
    return tuple(beside(part, depth, view) for part in _parts(mission)) if mission else ()


def gates(mission: Mission | None) -> list[Gate]:
    """Return the gates in their order."""
    return [each for each in mission.obstacle if isinstance(each, Gate)] if mission else []


def draw_legend(canvas: Canvas, view: View) -> None:
    """Write the scale and where north is, or from the side which way it looks."""
    room = canvas.columns // 4
    length = max((ruler for ruler in _RULERS if ruler / view.scale / 2 <= room), default=_RULERS[0])
    cells = max(round(length / view.scale / 2), 2)
    canvas.letters(1, canvas.rows - 1, f"├{'─' * (cells - 2)}┤ {length:g} m", Tone.MUTED)
    words = "N ↑" if view.plane is TOP else ("E →", "N →")[view.plane.across]
    canvas.letters(canvas.columns - 4, 0, words, Tone.MUTED)


def label_obstacles(canvas: Canvas, view: View, mission: Mission | None) -> None:
    """Write the obstacles' names under them, and the gates' numbers before their names."""
    numbers = {gate.name: f"{number} " for number, gate in enumerate(gates(mission), 1)}
    for obstacle in mission.obstacle if mission else ():
        _label(canvas, view, f"{numbers.get(obstacle.name, '')}{obstacle.name}", obstacle, Tone.MUTED)


def ring(canvas: Canvas, view: View, circle: tuple[float, float, float], tone: Tone, gap: int = 1) -> None:
    """Draw a circle of (across, upward, radius), m; of its dots only every so many, for a dotted one."""
    across, upward, radius = circle
    right, up = _circle(int(min(max(math.tau * radius / view.scale, 12), 2000)), gap)
    canvas.plot(view.x(across + radius * right), view.y(upward + radius * up), tone)


@lru_cache(maxsize=16)
def _circle(count: int, gap: int) -> tuple[Floats, Floats]:
    """Return every so many of so many points on a circle of radius 1; most rings stay as large as they are."""
    angles = np.arange(0, count, gap) * (math.tau / count)
    return np.cos(angles), np.sin(angles)


def cross(canvas: Canvas, x: float, y: float, arm: int, tone: Tone) -> None:
    """Draw a cross of so long arms, dots."""
    # What is not a number ends a line.
    canvas.line([x - arm, x + arm, math.nan, x, x], [y, y, math.nan, y - arm, y + arm], tone)


def silhouette(part: Primitive, view: View) -> Floats:
    """Return the outline of a part in the view's plane, m, closed, shape (n, 2)."""
    across, upward = view.plane.flat(part.center)
    if isinstance(part, Sphere) or (view.plane is TOP and not isinstance(part, Box)):
        angles = np.linspace(0.0, math.tau, _SIDES + 1)
        return np.stack(
            [across + part.radius * np.cos(angles), upward + part.radius * np.sin(angles)], axis=1
        )
    corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)], dtype=float)
    if view.plane is not TOP:
        lower, upper = extent(part)
        wide = 0.5 * (upper[view.plane.across] - lower[view.plane.across])
        return corners * (wide, half_height(part)) + (across, upward)
    assert isinstance(part, Box)
    yaw, (length, width, _) = math.radians(part.yaw_deg), part.size
    c, s = math.cos(yaw), math.sin(yaw)
    return (corners * (length / 2, width / 2)) @ np.array([(c, s), (-s, c)]) + (across, upward)


def _label(canvas: Canvas, view: View, words: str, obstacle: Obstacle, tone: Tone) -> None:
    lower, upper = (view.plane.flat(corner) for corner in extent(obstacle))
    column = int(view.x(0.5 * (lower[0] + upper[0])) / 2) - len(words) // 2
    row = int(view.y(lower[1]) / 4) + 1 if view.plane is TOP else int(view.y(upper[1]) / 4) - 1
    canvas.letters(column, row, words, tone)


def _parts(mission: Mission) -> list[Primitive]:
    return [part for obstacle in mission.obstacle for part in primitives(obstacle)]


def _grid(canvas: Canvas, view: View) -> None:
    """Dots on whole steps of a ruler, far enough apart to stay faint."""
    step = next((ruler for ruler in _RULERS if ruler / view.scale >= 10), _RULERS[-1])
    half_right, half_up = view.width * view.scale / 2, view.height * view.scale / 2
    rights = (
        np.arange(math.ceil((view.across - half_right) / step), (view.across + half_right) / step + 1) * step
    )
    ups = np.arange(math.ceil((view.upward - half_up) / step), (view.upward + half_up) / step + 1) * step
    grid_right, grid_up = np.meshgrid(rights, ups)
    canvas.plot(view.x(grid_right.ravel()), view.y(grid_up.ravel()), Tone.GRID)


def _hatch(canvas: Canvas, view: View, outline: Floats) -> None:
    """Fill a convex outline with dots."""
    x, y = view.x(outline[:, 0]), view.y(outline[:, 1])
    left, right = max(math.ceil(x.min()), 0), min(math.floor(x.max()), view.width - 1)
    top, bottom = max(math.ceil(y.min()), 0), min(math.floor(y.max()), view.height - 1)
    columns, rows = (axis.ravel() for axis in np.meshgrid(range(left, right + 1), range(top, bottom + 1)))
    chosen = (columns + rows) % 2 == 0
    columns, rows = columns[chosen], rows[chosen]
    inside: NDArray[np.bool_] = np.ones(len(columns), dtype=bool)
    for index in range(len(x) - 1):
        # Counter-clockwise in the world is clockwise in dots, which count downward.
        turn = (x[index + 1] - x[index]) * (rows - y[index]) - (y[index + 1] - y[index]) * (
            columns - x[index]
        )
        inside &= turn <= 1e-9
    canvas.plot(columns[inside], rows[inside], Tone.BESIDE)


def _pad(canvas: Canvas, view: View, pad: Pad) -> None:
    across, upward = view.plane.flat(pad.position)
    if view.plane is TOP:
        ring(canvas, view, (across, upward, max(pad.radius, 3.0 * view.scale)), Tone.MUTED)
    cross(canvas, float(view.x(across)), float(view.y(upward)), 1, Tone.MUTED)
