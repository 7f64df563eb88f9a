"""What obstacles look like from above, from the side and in space: polygons in metres, world ENU."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import radians

import numpy as np

from groundstation.review.series import Numbers
from sim.environment.shapes import half_height
from sim.scenario import Box, Primitive, Sphere

_ROUND = 48
_RINGS = 16
# The corners of a unit square, counter-clockwise.
_SQUARE = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])


def from_above(part: Primitive) -> Numbers:
    """Return the outline in x and y, (m, 2), counter-clockwise."""
    center = np.array(part.center[:2])
    if isinstance(part, Box):
        yaw = radians(part.yaw_deg)
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        return center + (_SQUARE * part.size[:2]) @ turn
    return center + part.radius * _circle()


def from_the_side(part: Primitive) -> Numbers:
    """Return the outline in x and z as seen along y, (m, 2)."""
    if isinstance(part, Sphere):
        return np.array((part.center[0], part.center[2])) + part.radius * _circle()
    x = from_above(part)[:, 0]
    low, high = part.center[2] - half_height(part), part.center[2] + half_height(part)
    return np.array([(x.min(), low), (x.max(), low), (x.max(), high), (x.min(), high)])


def faces(part: Primitive) -> Iterator[Numbers]:
    """Yield the faces as polygons, each (m, 3), counter-clockwise as seen from outside."""
    if isinstance(part, Sphere):
        yield from _sphere(part)
        return
    base = from_above(part)
    low, high = part.center[2] - half_height(part), part.center[2] + half_height(part)
    yield np.column_stack((base, np.full(len(base), high)))
    yield np.column_stack((base[::-1], np.full(len(base), low)))
    for (x0, y0), (x1, y1) in zip(base, np.roll(base, -1, axis=0), strict=True):
        yield np.array([(x0, y0, low), (x1, y1, low), (x1, y1, high), (x0, y0, high)])


def _sphere(part: Sphere) -> Iterator[Numbers]:
    around = _circle()
    heights = np.linspace(-np.pi / 2.0, np.pi / 2.0, _RINGS + 1)
    center = np.array(part.center)
    rings = [np.column_stack((np.cos(h) * around, np.full(_ROUND, np.sin(h)))) for h in heights]
    for low, high in pairwise(center + part.radius * ring for ring in rings):
        for index in range(_ROUND):
            after = (index + 1) % _ROUND
            yield np.array([low[index], low[after], high[after], high[index]])


def _circle() -> Numbers:
    angle = np.linspace(0.0, 2.0 * np.pi, _ROUND, endpoint=False)
    return np.column_stack((np.cos(angle), np.sin(angle)))
