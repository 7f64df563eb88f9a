"""The world as lines in space, for the views from within it: what stands still, and shapes to place. Pure NumPy.

World ENU, m. Lines are segments, shape (n, 2, 3).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from groundstation.training.mission import Mission
from groundstation.tui.camera import Solids
from sim.environment.shapes import half_height, primitives
from sim.scenario import Box, Cylinder, Gate, Obstacle, Primitive

Floats = NDArray[np.float64]

_SIDES = 16
_TURN = np.linspace(0.0, math.tau, _SIDES + 1)
_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1])
# Bodies of many faces lie within the round ones, so that a round one's own lines are not hidden by it.
_WITHIN = 0.97
_ARM_M, _ROTOR_M = 0.33, 0.17


def path(points: Floats) -> Floats:
    """Return the lines from point to point, shape (n, 3) to (n − 1, 2, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1)


def circle(
    center: Floats, radius: float, across: tuple[float, float, float], up: tuple[float, float, float]
) -> Floats:
    """Return a circle in the plane of two directions at right angles, both of length 1."""
    round_ = np.outer(np.cos(_TURN), across) + np.outer(np.sin(_TURN), up)
    return path(center + radius * round_)


def level_circle(center: Floats, radius: float) -> Floats:
    """Return a circle on one altitude."""
    return circle(center, radius, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def turned(points: Floats, yaw: float) -> Floats:
    """Turn points about the vertical, counter-clockwise from east, rad."""
    c, s = math.cos(yaw), math.sin(yaw)
    return points @ np.array([(c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)])


def contours(obstacle: Obstacle, eye: tuple[float, float, float]) -> Floats:
    """Return the lines that show an obstacle to an eye: edges, and where round bodies end for it."""
    if isinstance(obstacle, Gate):
        return _gate(obstacle)
    return np.concatenate([_contour(part, np.array(eye)) for part in primitives(obstacle)])


def _contour(part: Primitive, eye: Floats) -> Floats:
    center = np.array(part.center)
    if isinstance(part, Box):
        corners = center + turned(_CORNERS * np.array(part.size), math.radians(part.yaw_deg))
        return corners[_EDGES]
    way = eye - center
    if isinstance(part, Cylinder):
        up = np.array((0.0, 0.0, half_height(part)))
        distance = math.hypot(way[0], way[1])
        aside = math.acos(min(part.radius / max(distance, 1e-9), 1.0))
        angles = math.atan2(way[1], way[0]) + np.array([aside, -aside])
        feet = center + part.radius * np.stack([np.cos(angles), np.sin(angles), np.zeros(2)], axis=1)
        walls = np.stack([feet - up, feet + up], axis=1)
        rings = [level_circle(center + end, part.radius) for end in (up, -up)]
        return np.concatenate([walls, *rings])
    return np.concatenate([_outline_of_sphere(center, part.radius, way), level_circle(center, part.radius)])


def _outline_of_sphere(center: Floats, radius: float, way: Floats) -> Floats:
    """Return the circle in which lines of sight touch a sphere; `way` leads from it to the eye."""
    distance = float(np.linalg.norm(way))
    if distance <= radius:
        return np.zeros((0, 2, 3))
    toward = way / distance
    across = np.cross(toward, (0.0, 0.0, 1.0) if abs(toward[2]) < 0.9 else (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    near = radius * radius / distance
    size = math.sqrt(radius * radius - near * near)
    return circle(center + near * toward, size, tuple(across), tuple(np.cross(across, toward)))


def _gate(gate: Gate) -> Floats:
    """Return the opening and its frame as rectangles, and an arrow through it."""
    half, high, frame = gate.width / 2, gate.height / 2, gate.frame
    foot = -high - frame if gate.sill else -gate.center[2]
    inner = [(0, -half, -high), (0, -half, high), (0, half, high), (0, half, -high), (0, -half, -high)]
    wide, top = half + frame, high + frame
    outer = [(0, -wide, foot), (0, -wide, top), (0, wide, top), (0, wide, foot)]
    arrow = [(-0.4, 0, 0), (0.4, 0, 0), (0.15, 0.15, 0), (0.4, 0, 0), (0.15, -0.15, 0)]
    lines = np.concatenate([path(np.array(points, dtype=float)) for points in (inner, outer, arrow)])
    return turned(lines, math.radians(gate.yaw_deg)) + np.array(gate.center)


def solids(mission: Mission | None) -> Solids:
    """Return the obstacles of a mission as bodies that hide what is behind them."""
    parts = [part for obstacle in mission.obstacle for part in primitives(obstacle)] if mission else []
    tables = [_faces(part) for part in parts]
    counts = [len(normals) for normals, _ in tables]
    return Solids(
        normals=np.concatenate([np.zeros((0, 3)), *(normals for normals, _ in tables)]),
        offsets=np.concatenate([np.zeros(0), *(offsets for _, offsets in tables)]),
        firsts=np.cumsum([0, *counts[:-1]]).astype(np.intp) if counts else np.zeros(0, dtype=np.intp),
    )


def _faces(part: Primitive) -> tuple[Floats, Floats]:
    """Return the half-spaces of a part: outward normals and offsets from the world's origin."""
    center = np.array(part.center)
    if isinstance(part, Box):
        axes = turned(np.eye(3), math.radians(part.yaw_deg))
        normals = np.concatenate([axes, -axes])
        return normals, normals @ center + np.tile(np.array(part.size) / 2, 2)
    sides = np.stack([np.cos(_TURN[:-1]), np.sin(_TURN[:-1]), np.zeros(_SIDES)], axis=1)
    upright = np.array([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
    if isinstance(part, Cylinder):
        normals = np.concatenate([sides, upright])
        reach = np.array([_WITHIN * part.radius] * _SIDES + [half_height(part)] * 2)
        return normals, normals @ center + reach
    slopes = [math.cos(angle) * sides + math.sin(angle) * upright[0] for angle in (0.7, -0.7)]
    normals = np.concatenate([sides, *slopes, upright])
    return normals, normals @ center + _WITHIN * part.radius


def vehicle(position: Floats, yaw: float, pitch: float, roll: float) -> Floats:
    """Return a quadrotor of four arms and rotors, with a nose.

    Args:
        position: World, m.
        yaw: About up, rad.
        pitch: About left, rad.
        roll: About forward, rad.
    """
    diagonal = _ARM_M / math.sqrt(2)
    hubs = np.array([(x, y, 0.0) for x, y in ((1, 1), (1, -1), (-1, -1), (-1, 1))]) * diagonal
    arms = np.stack([np.zeros((4, 3)), hubs], axis=1)
    nose = path(
        np.array([(0.0, 0.0, 0.0), (0.42, 0.0, 0.0), (0.3, 0.07, 0.0), (0.42, 0.0, 0.0), (0.3, -0.07, 0.0)])
    )
    rotors = [level_circle(hub + np.array([0.0, 0.0, 0.05]), _ROTOR_M) for hub in hubs]
    lines = np.concatenate([arms, nose, *rotors])
    cp, sp, cr, sr = math.cos(pitch), math.sin(pitch), math.cos(roll), math.sin(roll)
    rolled = lines @ np.array([(1.0, 0.0, 0.0), (0.0, cr, sr), (0.0, -sr, cr)])
    pitched = rolled @ np.array([(cp, 0.0, -sp), (0.0, 1.0, 0.0), (sp, 0.0, cp)])
    return turned(pitched, yaw) + position


def diamond(center: Floats, size: float) -> Floats:
    """Return an octahedron's edges: a mark that looks the same from everywhere."""
    tips = np.concatenate([np.eye(3), -np.eye(3)]) * size + center
    pairs = np.array([(a, b) for a in range(6) for b in range(a + 1, 6) if b - a != 3])
    return tips[pairs]


def ground(eye: tuple[float, float, float], reach: float) -> Floats:
    """Return a grid on the ground around the eye, in pieces of a step: m, coarser from higher up.

    Args:
        eye: World, m.
        reach: How far it goes, m.
    """
    step = next((step for step in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0) if 6 * step >= reach), 100.0)
    middle = [round(value / step) * step for value in eye[:2]]
    return _grid(step, math.floor(reach / step)) + np.array([*middle, 0.0])


@lru_cache(maxsize=4)
def _grid(step: float, count: int) -> Floats:
    """Return a level grid of so many steps to each side of the origin, in pieces of a step, m."""
    ticks: Floats = np.arange(-count, count + 1, dtype=np.float64) * step
    across, along = (axis.ravel() for axis in np.meshgrid(ticks, ticks[:-1]))
    flat = np.zeros_like(across)
    starts = np.stack([across, along, flat], axis=1)
    ends = np.stack([across, along + step, flat], axis=1)
    north = np.stack([starts, ends], axis=1)
    return np.concatenate([north, north[:, :, [1, 0, 2]]])
