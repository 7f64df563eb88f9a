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
        across, down = np.atleast_1d(np.asarray(x, dtype=float)), np.atleast_1d(np.asarray(y, dtype=float))
        inside = (across > -0.5) & (across < self.width - 0.5) & (down > -0.5) & (down < self.height - 0.5)
        columns, rows = np.rint(across[inside]).astype(np.intp), np.rint(down[inside]).astype(np.intp)
        self._dots[rows, columns] = 1
        self._tones[rows >> 2, columns >> 1] = tone[inside] if isinstance(tone, np.ndarray) else tone

    def clear(self, x: ArrayLike, y: ArrayLike) -> None:
        """Take dots away, so that what is drawn next stands free; those outside or not finite are left out."""
        across, down = np.atleast_1d(np.asarray(x, dtype=float)), np.atleast_1d(np.asarray(y, dtype=float))
        inside = (across > -0.5) & (across < self.width - 0.5) & (down > -0.5) & (down < self.height - 0.5)
        self._dots[np.rint(down[inside]).astype(np.intp), np.rint(across[inside]).astype(np.intp)] = 0

    def line(self, x: ArrayLike, y: ArrayLike, tone: Tone, gap: int = 1) -> None:
        """Draw straight lines from point to point.

        Args:
            x: Dots from the left, shape (n,).
            y: Dots from the top, shape (n,).
            tone: Of their cells.
            gap: Only every so many dots, for dotted lines.
        """
        across, down = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        dots = dots_of(across[:-1], down[:-1], across[1:], down[1:], self.width, self.height, gap)
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


def dots_of(
    x0: Floats, y0: Floats, x1: Floats, y1: Floats, width: int, height: int, gap: int | NDArray[np.intp] = 1
) -> Dots:
    """Return the dots of straight lines, as far as they are within a picture (Liang and Barsky, 1984).

    Args:
        x0, y0, x1, y1: Their ends, dots, shape (n,). Lines with an end that is not finite have no dots.
        width, height: Of the picture, dots.
        gap: Only every so many dots, of all lines or of each.
    """
    finite = np.isfinite(x0) & np.isfinite(y0) & np.isfinite(x1) & np.isfinite(y1)
    # What is too far away to be reckoned with is not finite either.
    finite &= np.maximum(np.maximum(abs(x0), abs(x1)), np.maximum(abs(y0), abs(y1))) < 1e9
    ways = np.where(finite, x1 - x0, 0.0), np.where(finite, y1 - y0, 0.0)
    begin, end = np.zeros(len(x0)), np.where(finite, 1.0, -1.0)
    for start, way, size in ((x0, ways[0], width), (y0, ways[1], height)):
        still = abs(way) < 1e-9
        safe = np.where(still, 1.0, way)
        near, far = (-1.0 - start) / safe, (size - start) / safe
        begin = np.where(still, begin, np.maximum(begin, np.minimum(near, far)))
        end = np.where(still, end, np.minimum(end, np.maximum(near, far)))
        end = np.where(still & ((start < -1) | (start > size)), -1.0, end)
    steps = np.rint((end - begin) * np.maximum(abs(ways[0]), abs(ways[1])))
    whole = np.clip(np.where(end >= begin, steps, 0.0), 0, _LONGEST).astype(np.intp)
    counts = np.where(end >= begin, whole // gap + 1, 0)
    which = np.repeat(np.arange(len(x0)), counts)
    firsts = np.cumsum(counts) - counts
    number = (np.arange(len(which)) - firsts[which]) * (gap if isinstance(gap, int) else gap[which])
    share = begin[which] + (end - begin)[which] * number / np.maximum(whole, 1)[which]
    return Dots(x0[which] + ways[0][which] * share, y0[which] + ways[1][which] * share, share, which)


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
