"""A pinhole camera in the world: what is where in its picture, and what of it is hidden. Pure NumPy.

Its axes are the picture's: x to the right, y down, z ahead. World ENU, m; dots from the picture's top left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Nearer than this nothing is seen, m.
NEAR_M = 0.15
# A point this share before the end of its line of sight is still the surface itself.
_SKIN = 0.995


@dataclass(frozen=True, slots=True)
class Camera:
    """Where it stands, how it looks, and how large its picture is.

    Attributes:
        place: World, m.
        yaw: Counter-clockwise from east, rad.
        pitch: Upward, rad.
        roll: To the right, rad.
        focal: Dots from the eye to the picture.
        width, height: Of the picture, dots.
    """

    place: tuple[float, float, float]
    yaw: float
    pitch: float
    roll: float
    focal: float
    width: int
    height: int

    def axes(self) -> Floats:
        """Return right, down and ahead as rows in the world, shape (3, 3)."""
        cy, sy, cp, sp = math.cos(self.yaw), math.sin(self.yaw), math.cos(self.pitch), math.sin(self.pitch)
        ahead = np.array([cy * cp, sy * cp, sp])
        right, down = np.array([sy, -cy, 0.0]), np.array([cy * sp, sy * sp, -cp])
        cr, sr = math.cos(self.roll), math.sin(self.roll)
        return np.stack([cr * right + sr * down, cr * down - sr * right, ahead])

    def seen(self, points: Floats) -> Floats:
        """Return world points on the camera's axes, m.

        Args:
            points: Shape (..., 3).
        """
        return (points - np.array(self.place)) @ self.axes().T

    def picture(self, seen: Floats) -> tuple[Floats, Floats]:
        """Return the dots of points on the camera's axes; NaN for what is not before it.

        Args:
            seen: Shape (..., 3).

        Returns:
            x and y, each of shape (...).
        """
        depth = np.where(seen[..., 2] >= NEAR_M * _SKIN, seen[..., 2], np.nan)
        x = seen[..., 0] / depth * self.focal + (self.width - 1) / 2
        return x, seen[..., 1] / depth * self.focal + (self.height - 1) / 2

    def dots(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the dots of world points, shape (..., 3); NaN for what is not before the camera."""
        return self.picture(self.seen(points))


def before(segments: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Cut segments at the nearest plane that is seen.

    Args:
        segments: On the camera's axes, m, shape (n, 2, 3).

    Returns:
        The segments cut, shape (n, 2, 3), and which have a part that is seen, shape (n,).
    """
    depth = segments[:, :, 2]
    ahead = depth >= NEAR_M
    way = depth[:, 1] - depth[:, 0]
    share = (NEAR_M - depth[:, 0]) / np.where(abs(way) < 1e-12, 1.0, way)
    crossing = segments[:, 0] + share[:, None] * (segments[:, 1] - segments[:, 0])
    cut = np.where(ahead[:, :, None], segments, crossing[:, None, :])
    return cut, ahead[:, 0] | ahead[:, 1]


@dataclass(frozen=True, slots=True)
class Solids:
    """Convex bodies as half-spaces n·x ≤ c, all in one table.

    Attributes:
        normals: Outward, shape (k, 3).
        offsets: Shape (k,).
        firsts: The first half-space of each body, shape (m,).
    """

    normals: Floats
    offsets: Floats
    firsts: NDArray[np.intp]

    def hide(self, eye: tuple[float, float, float], points: Floats) -> NDArray[np.bool_]:
        """Say which points are behind a body as seen from an eye; a body that the eye is in hides nothing.

        Args:
            eye: World, m.
            points: World, m, shape (n, 3).
        """
        if not len(self.firsts) or not len(points):
            return np.zeros(len(points), dtype=bool)
        way = (points - np.array(eye)) @ self.normals.T
        slack = self.offsets - self.normals @ np.array(eye)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            share = slack / way
        # Along the line of sight from 0 to 1: where it comes into each half-space, and where it leaves it.
        inward = np.where(way < 0.0, share, np.where((way == 0.0) & (slack < 0.0), np.inf, -np.inf))
        outward = np.where(way > 0.0, share, np.inf)
        enters = np.maximum.reduceat(inward, self.firsts, axis=1)
        leaves = np.minimum.reduceat(outward, self.firsts, axis=1)
        return np.logical_or.reduce((enters > 0.0) & (enters < _SKIN) & (enters < leaves), axis=1)


NOTHING = Solids(np.zeros((0, 3)), np.zeros(0), np.zeros(0, dtype=np.intp))
"""What hides nothing."""
