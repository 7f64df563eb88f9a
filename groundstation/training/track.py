"""Where a flight went, kept as it is flown: a place every so often, an hour in half a megabyte."""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.frames import Vector3
from groundstation.training.measures import Track
from groundstation.training.rows import Rows

# Five rows a second show a multirotor's way, s.
_EVERY_S = 0.2


class TrackKeeper:
    """Keeps the places; where nothing is seen, while the hand does not lead, it is taken to stand."""

    def __init__(self) -> None:
        self._places = Rows[Vector3](tuple, _place, 3)
        self._last: Vector3 | None = None

    def add(self, since: float, place: Vector3) -> None:
        """Take note of where it is (world, m), `since` its take-off, s, ascending."""
        while self._last is not None and len(self._places) * _EVERY_S < since:
            self._places.append(self._last)
        self._last = place

    def until(self, since: float) -> Track:
        """Return the way from take-off until `since` then, s; none where nothing was seen."""
        if self._last is None:
            return Track(_EVERY_S)
        seen = list(self._places)
        standing = int(since / _EVERY_S) + 1 - len(seen)
        return Track(_EVERY_S, (*seen, *[self._last] * standing))


def _place(numbers: Sequence[float]) -> Vector3:
    x, y, z = numbers
    return x, y, z
