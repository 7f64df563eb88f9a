"""The flight seen from above and from the side, to scale, with the hull drawn at equal times."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from groundstation.report.figures import outlines, style
from groundstation.report.figures.view import View, moments
from groundstation.review.series import Numbers, lengths
from sim.environment.shapes import primitives
from sim.scenario import Primitive

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HULL_EVERY_S = 2.0
# Length of the wind's arrows, m for a m/s.
WIND_M_PER_MPS = 0.6
_CALM = 0.05
_BELOW_GROUND_M = 0.15
_ABOVE, _SIDE = [0, 1], [0, 2]
_LABELS = ("x east, m", "y north, m", "z up, m")


def from_above(axes: Axes, view: View) -> None:
    """Draw x and y, with the obstacles' names, and the wind where it blows."""
    _draw(axes, view, _ABOVE, outlines.from_above)
    for obstacle in view.mission.obstacle:
        outline = np.concatenate([outlines.from_above(part) for part in primitives(obstacle)])
        x, y = outline.mean(axis=0)
        style.name(axes, float(x), float(y), obstacle.name)
    _wind(axes, view)


def from_the_side(axes: Axes, view: View) -> None:
    """Draw x and z, as seen along y."""
    axes.axhline(0.0, color=style.FAINT, linewidth=style.THIN)
    _draw(axes, view, _SIDE, outlines.from_the_side)
    axes.set_ylim(-_BELOW_GROUND_M, view.high[2])


def _draw(axes: Axes, view: View, plane: list[int], outline: Callable[[Primitive], Numbers]) -> None:
    across, up = plane
    for obstacle in view.mission.obstacle:
        for part in primitives(obstacle):
            axes.fill(*outline(part).T, facecolor=style.OBSTACLE, edgecolor=style.OBSTACLE_EDGE, alpha=0.8)
    axes.plot(view.p[:, across], view.p[:, up], color=style.VEHICLE, label="vehicle, $p$", zorder=3)
    axes.plot(
        view.p_h[:, across], view.p_h[:, up], color=style.HAND, linewidth=style.THIN, label="hand, $p_h$"
    )
    _hulls(axes, view, plane)
    _marks(axes, view, plane)
    axes.set_xlim(view.low[across], view.high[across])
    axes.set_ylim(view.low[up], view.high[up])
    axes.set_aspect("equal")
    axes.set_xlabel(_LABELS[across])
    axes.set_ylabel(_LABELS[up])


def _hulls(axes: Axes, view: View, plane: list[int]) -> None:
    """Draw the hull every few seconds: where circles crowd, the vehicle was slow."""
    from matplotlib.collections import EllipseCollection

    places = view.p[moments(view.t, HULL_EVERY_S)][:, plane]
    size = np.full(len(places), 2.0 * view.radius)
    hulls = EllipseCollection(
        size, size, np.zeros(len(places)), units="xy", offsets=places, offset_transform=axes.transData,
        facecolors="none", edgecolors=[style.VEHICLE], linewidths=style.HAIR,
    )  # fmt: skip
    axes.add_collection(hulls)
    axes.plot(
        [], [], linestyle="none", marker="o", markersize=6, markerfacecolor="none", markeredgecolor=style.VEHICLE,
        markeredgewidth=style.HAIR, label=f"hull, every {HULL_EVERY_S:g} s",
    )  # fmt: skip


def _marks(axes: Axes, view: View, plane: list[int]) -> None:
    """Mark the points that the operator was told to pass, and the target."""
    if view.mission.route:
        points = np.array([point.at for point in view.mission.waypoints])
        axes.plot(
            *points[:, plane].T, linestyle="none", marker="o", markersize=3,
            markerfacecolor="white", markeredgecolor=style.FAINT, markeredgewidth=style.THIN, label="route", zorder=2,
        )  # fmt: skip
    if view.mission.target:
        axes.plot(
            *np.array(view.mission.target.position)[plane], linestyle="none", marker="*", markersize=9,
            markerfacecolor=style.TARGET, markeredgecolor="white", markeredgewidth=0.6, label="target", zorder=5,
        )  # fmt: skip


def _wind(axes: Axes, view: View) -> None:
    """Draw the wind as arrows from the places where the hull is drawn, as far as these are apart."""
    known = moments(view.t, HULL_EVERY_S)
    at = list(_apart(view, known[np.isfinite(view.wind[known]).all(axis=1)]))
    if not at or lengths(view.wind[at]).max() < _CALM:
        return
    x, y = view.p[at, 0], view.p[at, 1]
    arrows = axes.quiver(
        x, y, view.wind[at, 0], view.wind[at, 1], units="xy", angles="xy", scale_units="xy",
        scale=1.0 / WIND_M_PER_MPS, color=style.WIND, width=0.07, zorder=4,
    )  # fmt: skip
    small = {"size": style.SMALL}
    axes.quiverkey(arrows, 0.93, 1.05, 1.0, "wind 1 m/s", labelpos="W", fontproperties=small)


def _apart(view: View, at: Iterable[int]) -> Iterator[int]:
    """Yield those moments at which the vehicle is not still in the hull drawn before."""
    last = None
    for moment in at:
        if last is None or math.dist(view.p[moment, :2], view.p[last, :2]) > 2.0 * view.radius:
            last = moment
            yield moment
