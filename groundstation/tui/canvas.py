"""Drawing with braille: two by four dots a cell, so that dots are square in a usual terminal.

NumPy all through: a whole frame is a few array operations, and rendering a line only indexes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from groundstation.tui.rows import Row
from groundstation.tui.theme import Tone

_BRAILLE = 0x2800
# Bit of each dot of a cell, by row, then column (Unicode chapter 21.1).
_BITS = tuple(
    (row, column, bit)
    for row, bits in enumerate(((0, 3), (1, 4), (2, 5), (6, 7)))
    for column, bit in enumerate(bits)
)
_SPACE = ord(" ")
_TONES = tuple(Tone)
# Further away than this nothing is drawn, dots.
_FAR = 1e9
# Longer lines are nobody's drawing, dots.
_LONGEST = 4096

Floats = NDArray[np.float64]
Tones = Tone | NDArray[np.uint8]


class Canvas:
    """A grid of dots with a tone a cell and letters over it. Origin top left, x right, y down, in dots.

    What is drawn later covers earlier tones of the same cell; dots add up.

    Args:
        columns: Cells across.
        rows: Cells down.
    """

    def __init__(self, columns: int, rows: int) -> None:
        self.columns, self.rows = columns, rows
        self.width, self.height = 2 * columns, 4 * rows
        self._dots = np.zeros((self.height, self.width), dtype=np.uint8)
        self._tones = np.zeros((rows, columns), dtype=np.uint8)
        self._letters = np.zeros((rows, columns), dtype=np.uint32)
        self._letter_tones = np.zeros((rows, columns), dtype=np.uint8)

    def copy(self) -> Canvas:
        """Return a canvas with the same drawing, to draw on."""
        twin = Canvas.__new__(Canvas)
        twin.columns, twin.rows, twin.width, twin.height = self.columns, self.rows, self.width, self.height
        twin._dots, twin._tones = self._dots.copy(), self._tones.copy()  # noqa: SLF001 - its own kind
        twin._letters, twin._letter_tones = self._letters.copy(), self._letter_tones.copy()  # noqa: SLF001
        return twin

    def plot(self, x: ArrayLike, y: ArrayLike, tone: Tones) -> None:
        """Set dots; those outside or not finite are left out.

        Args:
            x: Dots from the left, shape (n,).
            y: Dots from the top, shape (n,).
            tone: Of their cells: one, or one a dot.
        """
        columns, rows, inside = self._cells(x, y)
        self._dots[rows, columns] = 1
        self._tones[rows >> 2, columns >> 1] = tone[inside] if isinstance(tone, np.ndarray) else tone

    def clear(self, x: ArrayLike, y: ArrayLike) -> None:
        """Take dots away, so that what is drawn next stands free; those outside or not finite are left out."""
        columns, rows, _ = self._cells(x, y)
        self._dots[rows, columns] = 0

    def _cells(
        self, x: ArrayLike, y: ArrayLike
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """Return columns and rows of the dots that are within, and which those are."""
        # Half a dot is always rounded up: rounded to even numbers, every second dot of a line would be missing.
        across = np.floor(np.atleast_1d(np.asarray(x, dtype=float)) + 0.5)
        down = np.floor(np.atleast_1d(np.asarray(y, dtype=float)) + 0.5)
        inside = (across >= 0.0) & (across < self.width) & (down >= 0.0) & (down < self.height)
        return across[inside].astype(np.intp), down[inside].astype(np.intp), inside

    def line(self, x: ArrayLike, y: ArrayLike, tone: Tone, gap: int = 1) -> None:
        """Draw straight lines from point to point.

        Args:
            x: Dots from the left, shape (n,).
            y: Dots from the top, shape (n,).
            tone: Of their cells.
            gap: Only every so many dots, for dotted lines.
        """
        across, down = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        ends = [np.stack([axis[:-1], axis[1:]], axis=1) for axis in (across, down)]
        dots = dots_of(ends[0], ends[1], (self.width, self.height), gap)
        self.plot(dots.x, dots.y, tone)

    def letters(self, column: int, row: int, text: str, tone: Tone) -> None:
        """Write over the dots, starting in a cell; what is outside is cut."""
        if not 0 <= row < self.rows:
            return
        text = text[max(-column, 0) : max(self.columns - column, 0)]
        start = max(column, 0)
        self._letters[row, start : start + len(text)] = [ord(letter) for letter in text]
        self._letter_tones[row, start : start + len(text)] = tone

    def to_rows(self) -> list[Row]:
        """Return the drawing as rows of runs of equal tone."""
        bits = np.zeros((self.rows, self.columns), dtype=np.uint8)
        for row, column, bit in _BITS:
            bits |= self._dots[row::4, column::2] << bit
        written = self._letters != 0
        codes = np.where(
            written, self._letters, np.where(bits == 0, _SPACE, _BRAILLE + bits.astype(np.uint32))
        )
        tones = np.where(codes == _SPACE, 0, np.where(written, self._letter_tones, self._tones))
        return _runs(codes, tones)


class Dots(NamedTuple):
    """Dots of lines.

    Attributes:
        x, y: Dots from the left and from the top, shape (m,).
        share: How far along its line each is, 0 to 1, shape (m,).
        line: To which line it belongs, shape (m,).
    """

    x: Floats
    y: Floats
    share: Floats
    line: NDArray[np.intp]


def dots_of(x: Floats, y: Floats, size: tuple[int, int], gap: int | NDArray[np.intp] = 1) -> Dots:
    """Return the dots of straight lines, as far as they are within a picture (Liang and Barsky, 1984).

    Args:
        x: Their ends, dots from the left, shape (n, 2). Lines with an end that is not finite have no dots.
        y: Likewise from the top.
        size: Width and height of the picture, dots.
        gap: Only every so many dots, of all lines or of each.
    """
    # What is too far away to be reckoned with is not finite either; NaN is not less than anything.
    finite = np.logical_and.reduce((abs(x) < _FAR) & (abs(y) < _FAR), axis=1)
    ends = [np.where(finite[:, None], axis, 0.0) for axis in (x, y)]
    starts, ways = [axis[:, 0] for axis in ends], [axis[:, 1] - axis[:, 0] for axis in ends]
    begin, end = np.zeros(len(x)), np.where(finite, 1.0, -1.0)
    for start, way, edge in zip(starts, ways, size, strict=True):
        still = abs(way) < 1e-9
        safe = np.where(still, 1.0, way)
        near, far = (-1.0 - start) / safe, (edge - start) / safe
        begin = np.where(still, begin, np.maximum(begin, np.minimum(near, far)))
        end = np.where(still, end, np.minimum(end, np.maximum(near, far)))
        end = np.where(still & ((start < -1) | (start > edge)), -1.0, end)
    steps = np.rint((end - begin) * np.maximum(abs(ways[0]), abs(ways[1])))
    whole = np.clip(np.where(end >= begin, steps, 0.0), 0, _LONGEST).astype(np.intp)
    counts = np.where(end >= begin, whole // gap + 1, 0)
    which = np.repeat(np.arange(len(x)), counts)
    firsts = np.cumsum(counts) - counts
    number = (np.arange(len(which)) - firsts[which]) * (gap if isinstance(gap, int) else gap[which])
    share = begin[which] + (end - begin)[which] * number / np.maximum(whole, 1)[which]
    across, down = (start[which] + way[which] * share for start, way in zip(starts, ways, strict=True))
    return Dots(across, down, share, which)


def _runs(codes: NDArray[np.uint32], tones: NDArray[np.uint8]) -> list[Row]:
    """Return rows of runs of equal tone."""
    rows, columns = codes.shape
    text = codes.astype("<u4").tobytes().decode("utf-32-le")
    edge = np.ones((rows, columns), dtype=bool)
    edge[:, 1:] = tones[:, 1:] != tones[:, :-1]
    starts = np.flatnonzero(edge)
    kinds = tones.ravel()[starts].tolist()
    places = [*starts.tolist(), rows * columns]
    drawn: list[Row] = [[] for _ in range(rows)]
    for index, kind in enumerate(kinds):
        start = places[index]
        drawn[start // columns].append((text[start : places[index + 1]], _TONES[kind]))
    return drawn
