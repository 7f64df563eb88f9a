"""What is kept of a flight, row by row: an hour in a dozen megabytes, and nothing for the collector to visit."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, TypeVar, overload

from groundstation.frames import Vector3

Row = TypeVar("Row")


class Rows(Sequence[Row], Generic[Row]):
    """Rows of numbers, kept as numbers and given as what they stand for.

    Args:
        pack: Returns a row's numbers, always as many.
        unpack: Returns the row from them.
        width: How many they are.
    """

    def __init__(
        self, pack: Callable[[Row], Sequence[float]], unpack: Callable[[Sequence[float]], Row], width: int
    ) -> None:
        self._pack, self._unpack, self._width = pack, unpack, width
        self._numbers = array("d")

    def append(self, row: Row) -> None:
        """Keep a row."""
        self._numbers.extend(self._pack(row))

    def __len__(self) -> int:
        return len(self._numbers) // self._width

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> list[Row]: ...
    def __getitem__(self, index: int | slice) -> Row | list[Row]:
        if isinstance(index, slice):
            return [self[place] for place in range(*index.indices(len(self)))]
        place = range(len(self))[index] * self._width
        return self._unpack(self._numbers[place : place + self._width])


class VehicleRow(NamedTuple):
    """What is kept of a `VehicleSight` while the hand leads: speed in m/s, clearance and way off in m."""

    t: float
    position: Vector3
    speed: float
    clearance: float
    off_the_way: float

    @staticmethod
    def numbers(row: VehicleRow) -> Sequence[float]:
        """Return a row as seven numbers."""
        return row.t, *row.position, row.speed, row.clearance, row.off_the_way

    @classmethod
    def of(cls, numbers: Sequence[float]) -> VehicleRow:
        """Return the row that seven numbers stand for."""
        t, x, y, z, speed, clearance, off_the_way = numbers
        return cls(t, (x, y, z), speed, clearance, off_the_way)


class HandRow(NamedTuple):
    """What is kept of a `HandSight` while the hand leads: |p̃| in m, disagreement in m/s, force in N."""

    t: float
    error: float
    disagreement: float
    force: float
    on_leash: bool

    @staticmethod
    def numbers(row: HandRow) -> Sequence[float]:
        """Return a row as five numbers."""
        return row

    @classmethod
    def of(cls, numbers: Sequence[float]) -> HandRow:
        """Return the row that five numbers stand for."""
        t, error, disagreement, force, on_leash = numbers
        return cls(t, error, disagreement, force, bool(on_leash))
