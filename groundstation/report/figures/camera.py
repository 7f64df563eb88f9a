"""A pinhole camera: world points to the picture, and which of them an obstacle hides."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from groundstation.review.series import Numbers
from sim.environment.world import World


class Camera(NamedTuple):
    """Where it is and how it looks; all (3,), world.

    Attributes:
        eye: m.
        ahead, right, up: Unit vectors.
    """

    eye: Numbers
    ahead: Numbers
    right: Numbers
    up: Numbers

    def picture(self, points: Numbers) -> Numbers:
        """Return where points (n, 3) are in the picture, (n, 2), in units of the focal length."""
        seen = points - self.eye
        depth = seen @ self.ahead
        return np.column_stack((seen @ self.right, seen @ self.up)) / depth[:, None]

    def hidden(self, points: Numbers, world: World) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Say which points (n, 3) lie behind an obstacle, (n,)."""
        ways = points - self.eye
        far = np.sqrt(np.square(ways).sum(axis=1))
        x, y, z = self.eye
        origin = (float(x), float(y), float(z))
        return np.array(
            [
                world.ray(origin, (float(u), float(v), float(w)), float(limit)) < limit
                for (u, v, w), limit in zip(ways / far[:, None], far, strict=True)
            ],
            dtype=np.bool_,
        )


def looking_at(low: Numbers, high: Numbers, azimuth_deg: float, elevation_deg: float, away: float) -> Camera:
    """Return a camera that looks at the middle of a box of the world.

    Args:
        low: The box' lower corner, (3,), m.
        high: Its upper corner.
        azimuth_deg: Where the camera stands as seen from the middle, counter-clockwise from east.
        elevation_deg: How high, above the horizon.
        away: Its distance, as a multiple of the box' diagonal: the nearer, the stronger the perspective.
    """
    azimuth, elevation = np.radians(azimuth_deg), np.radians(elevation_deg)
    back = np.array(
        (np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation))
    )
    right = np.array((-np.sin(azimuth), np.cos(azimuth), 0.0))
    middle = 0.5 * (low + high)
    eye = middle + away * float(np.linalg.norm(high - low)) * back
    return Camera(eye, -back, right, np.cross(back, right))
