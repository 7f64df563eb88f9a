"""Which part of the world a flat map shows: from above with north up, or from the side with up up.

Dots are square, so one scale holds for both axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from groundstation.training.mission import Mission
from sim.environment.shapes import extent

Floats = NDArray[np.float64]
Point = Sequence[float]

# Free flight shows at least this far around the start, and so much above it from the side, m.
LEAST_HALF_M, LEAST_UP_M = 4.0, 3.0
MARGIN_M = 1.0
# Metres a dot.
SCALES = tuple(
    step * 10.0**power
    for power in range(-2, 4)
    for step in (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.4, 8.0)
)
# A map that follows moves only when the vehicle leaves this share of it: a map that crawls is not read.
_CALM = 0.5


class Plane(NamedTuple):
    """What a map lies in: which of east, north and up goes to the right, which upward, and which is not seen."""

    across: int
    upward: int
    depth: int

    def flat(self, point: Point) -> tuple[float, float]:
        """Return a world point in the plane, m."""
        return point[self.across], point[self.upward]


TOP, SIDE_EAST, SIDE_NORTH = Plane(0, 1, 2), Plane(0, 2, 1), Plane(1, 2, 0)


def side_of(mission: Mission | None) -> Plane:
    """Return the side from which a mission is seen at its longest."""
    points = _points(mission)
    spans = [max(point[axis] for point in points) - min(point[axis] for point in points) for axis in (0, 1)]
    return SIDE_NORTH if spans[1] > spans[0] else SIDE_EAST


@dataclass(frozen=True, slots=True)
class View:
    """Which part of a plane a canvas shows.

    Attributes:
        across, upward: The point of the plane in its middle, m.
        scale: Metres a dot.
        width, height: Dots.
        plane: Of the map.
    """

    across: float
    upward: float
    scale: float
    width: int
    height: int
    plane: Plane = TOP

    def x(self, across: Floats | float) -> Floats:
        """Return dots from the left."""
        return np.asarray((across - self.across) / self.scale + (self.width - 1) / 2)

    def y(self, upward: Floats | float) -> Floats:
        """Return dots from the top."""
        return np.asarray((self.upward - upward) / self.scale + (self.height - 1) / 2)

    def dots(self, points: Floats) -> tuple[Floats, Floats]:
        """Return dots from left and top of world points, m, shape (n, 3)."""
        return self.x(points[:, self.plane.across]), self.y(points[:, self.plane.upward])

    def holds(self, points: Sequence[tuple[float, float]]) -> bool:
        """Say whether all points of the plane are within the picture, a little off its edge."""
        right, up = 0.5 * self.scale * (self.width - 6), 0.5 * self.scale * (self.height - 6)
        return all(abs(x - self.across) <= right and abs(y - self.upward) <= up for x, y in points)

    def calm(self, point: tuple[float, float]) -> bool:
        """Say whether a point of the plane is near enough to the middle for the map to stay."""
        x, y = abs(point[0] - self.across), abs(point[1] - self.upward)
        return max(x / max(self.width, 1), y / max(self.height, 1)) <= 0.5 * _CALM * self.scale


def framing(
    mission: Mission | None,
    points: Sequence[tuple[float, float]],
    width: int,
    height: int,
    plane: Plane = TOP,
) -> View:
    """Return the view that shows the start, the mission and further points, at a scale from a fixed ladder.

    Args:
        mission: What is flown, or None.
        points: Further points of the plane, m, that shall be seen.
        width: Dots across.
        height: Dots down.
        plane: Of the map.
    """
    seen = [*(plane.flat(point) for point in _points(mission)), *points]
    rights, ups = [point[0] for point in seen], [point[1] for point in seen]
    spans = (max(rights) - min(rights) + 2 * MARGIN_M, max(ups) - min(ups) + 2 * MARGIN_M)
    least = max(spans[0] / max(width - 6, 1), spans[1] / max(height - 6, 1))
    scale = next((scale for scale in SCALES if scale >= least), SCALES[-1])
    return View((max(rights) + min(rights)) / 2, (max(ups) + min(ups)) / 2, scale, width, height, plane)


def zoomed(scale: float, steps: int) -> float:
    """Return the scale so many steps of the ladder further in, or out where negative, m a dot."""
    nearest = min(range(len(SCALES)), key=lambda index: abs(SCALES[index] - scale))
    return SCALES[max(0, min(nearest - steps, len(SCALES) - 1))]


def _points(mission: Mission | None) -> list[Point]:
    """Return what shall always be seen, world, m."""
    found: list[Point] = [(-LEAST_HALF_M / 2, 0.0, 0.0), (LEAST_HALF_M / 2, 0.0, LEAST_UP_M)]
    if mission is not None:
        found += mission.way
        found += [corner for obstacle in mission.obstacle for corner in extent(obstacle)]
        for pad in mission.pad:
            east, north, up = pad.position
            found += [
                (east - pad.radius, north - pad.radius, up),
                (east + pad.radius, north + pad.radius, up),
            ]
    return found
