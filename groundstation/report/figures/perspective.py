"""The flight in perspective: ground, obstacles, the way flown with its shadow, and the target."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from groundstation.report.figures import outlines, style
from groundstation.report.figures.camera import Camera, looking_at
from groundstation.report.figures.view import View
from groundstation.review.series import Numbers
from sim.environment.shapes import extent
from sim.environment.world import World
from sim.scenario import Obstacle, Primitive

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_AZIMUTH_DEG, _ELEVATION_DEG, _AWAY = -72.0, 29.0, 2.4
_LIGHT = np.array((-0.45, -0.55, 0.70))
# Points.
_NAME_BELOW = 7.0
_GRID_M, _NUMBERS_M = 2.0, 4.0
_GROUND = (0.975, 0.975, 0.975)
# From the back to the front.
_ON_GROUND, _SOLIDS, _WAY, _WORDS = 0.5, 1.0, 2.0, 3.0


def draw(axes: Axes, view: View) -> None:
    """Draw the whole of it; the picture's axes have no scale of their own, the ground has."""
    camera = looking_at(view.low, view.high, _AZIMUTH_DEG, _ELEVATION_DEG, _AWAY)
    world = World(view.mission.obstacle)
    _ground(axes, camera, view)
    _shadow(axes, camera, view.p)
    for part in _back_to_front(camera, world.primitives):
        _solid(axes, camera, part)
    _names(axes, camera, view.mission.obstacle)
    _trail(axes, camera, view.p, world)
    if view.mission.target:
        _target(axes, camera, np.array(view.mission.target.position))
    axes.set_aspect("equal")
    axes.set_axis_off()


def _ground(axes: Axes, camera: Camera, view: View) -> None:
    """Draw the plane z = 0 with lines every 2 m, numbered along its front edges."""
    from matplotlib.collections import LineCollection

    (x0, y0, _), (x1, y1, _) = view.low, view.high
    edge = np.array([(x0, y0, 0.0), (x1, y0, 0.0), (x1, y1, 0.0), (x0, y1, 0.0)])
    axes.fill(*camera.picture(edge).T, facecolor=_GROUND, edgecolor=style.GRID, zorder=0.0)
    lines = [np.array([(x, y0, 0.0), (x, y1, 0.0)]) for x in _multiples(_GRID_M, x0, x1)]
    lines += [np.array([(x0, y, 0.0), (x1, y, 0.0)]) for y in _multiples(_GRID_M, y0, y1)]
    pictures = [camera.picture(line) for line in lines]
    axes.add_collection(
        LineCollection(pictures, colors=[style.GRID], linewidths=style.HAIR, zorder=0.1), autolim=False
    )
    for x in _multiples(_NUMBERS_M, x0, x1):
        _number(axes, camera, (x, y0), (0.0, -0.35), f"{x:g}")
    for y in _multiples(_GRID_M, y0, y1):
        _number(axes, camera, (x1, y), (0.3, 0.0), f"{y:g}")
    _number(axes, camera, (0.5 * (x0 + x1), y0), (0.0, -1.1), "x east, m")
    _number(axes, camera, (x1, 0.5 * (y0 + y1)), (1.7, 0.0), "y north, m")


def _number(
    axes: Axes, camera: Camera, at: tuple[float, float], aside: tuple[float, float], words: str
) -> None:
    x, y = camera.picture(np.array([(at[0] + aside[0], at[1] + aside[1], 0.0)]))[0]
    axes.text(
        float(x),
        float(y),
        words.replace("-", "−"),
        ha="center",
        va="center",
        fontsize=style.SMALL,
        color=style.FAINT,
    )


def _multiples(step: float, low: float, high: float) -> Numbers:
    return np.arange(np.ceil(low / step), high / step + 1e-9) * step + 0.0


def _shadow(axes: Axes, camera: Camera, p: Numbers) -> None:
    """Draw what the vehicle was above: without it nobody sees how high and how far a line in space is."""
    x, y = camera.picture(_on_ground(p)).T
    axes.plot(x, y, color=style.FAINT, linewidth=style.THIN, alpha=0.6, zorder=_ON_GROUND)


def _on_ground(points: Numbers) -> Numbers:
    return points[:, :3] * (1.0, 1.0, 0.0)


def _back_to_front(camera: Camera, parts: Iterable[Primitive]) -> list[Primitive]:
    return sorted(parts, key=lambda part: -math.dist(part.center, camera.eye))


def _solid(axes: Axes, camera: Camera, part: Primitive) -> None:
    """Draw the faces that look at the camera, the brighter the more they look at the light."""
    from matplotlib.collections import PolyCollection

    shown: list[Numbers] = []
    colours: list[style.Colour] = []
    for face in outlines.faces(part):
        normal = np.cross(face[1] - face[0], face[2] - face[1])
        if normal @ (camera.eye - face[0]) <= 0.0:
            continue
        light = 0.72 + 0.36 * max(0.0, float(normal @ _LIGHT) / float(np.linalg.norm(normal)))
        red, green, blue = (min(1.0, light * channel) for channel in style.OBSTACLE)
        shown.append(camera.picture(face))
        colours.append((red, green, blue))
    axes.add_collection(
        PolyCollection(shown, facecolors=colours, edgecolors=colours, linewidths=0.3, zorder=_SOLIDS)
    )


def _names(axes: Axes, camera: Camera, obstacles: Iterable[Obstacle]) -> None:
    """Write each obstacle's name below it."""
    for obstacle in obstacles:
        low, high = (np.array(corner) for corner in extent(obstacle))
        x, y = camera.picture(np.array([(0.5 * (low[0] + high[0]), low[1], low[2])]))[0]
        style.name(axes, float(x), float(y), obstacle.name, below=_NAME_BELOW)


def _trail(axes: Axes, camera: Camera, p: Numbers, world: World) -> None:
    """Draw the way flown; where an obstacle hides it, faint."""
    way = p[:, :3]
    hidden = camera.hidden(way, world)
    x, y = camera.picture(way).T
    axes.plot(x, np.where(hidden, np.nan, y), color=style.VEHICLE, zorder=_WAY)
    axes.plot(
        x, np.where(hidden, y, np.nan), color=style.VEHICLE, linewidth=style.THIN, linestyle=style.DASHED, zorder=_WAY
    )  # fmt: skip


def _target(axes: Axes, camera: Camera, position: Numbers) -> None:
    point = position[None, :]
    plumb = camera.picture(np.vstack((point, _on_ground(point))))
    axes.plot(*plumb.T, color=style.TARGET, linewidth=style.THIN, zorder=_WAY)
    axes.plot(
        *plumb[0], marker="*", markersize=9, markerfacecolor=style.TARGET, markeredgecolor="white",
        markeredgewidth=0.6, zorder=_WORDS,
    )  # fmt: skip
