"""What is kept of a flight, row by row: an hour in a dozen megabytes, and nothing for the collector to visit."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar, overload

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
