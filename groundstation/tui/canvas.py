"""Drawing with braille: two by four dots a cell, so that dots are square in a usual terminal.

NumPy all through: a whole frame is a few array operations, and rendering a line only indexes.
"""

from __future__ import annotations

import math
from copy import deepcopy
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from groundstation.tui.rows import Row
from groundstation.tui.theme import Tone

_BRAILLE = 0x2800
# Bits of the dots of a cell, row by row, left then right (Unicode chapter 21.1).
_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], dtype=np.uint32)
_SPACE = ord(" ")

Floats = NDArray[np.float64]


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
        self._dots = np.zeros((self.height, self.width), dtype=np.uint32)
        self._tones = np.zeros((rows, columns), dtype=np.uint8)
        self._letters = np.zeros((rows, columns), dtype=np.uint32)
        self._letter_tones = np.zeros((rows, columns), dtype=np.uint8)

    def copy(self) -> Canvas:
        """Return a canvas with the same drawing, to draw on."""
        return deepcopy(self)

    def plot(self, x: ArrayLike, y: ArrayLike, tone: Tone) -> None:
        """Set dots; those outside or not finite are left out.

        Args:
            x: Dots from the left, shape (n,).
            y: Dots from the top, shape (n,).
            tone: Of their cells.
        """
        across, down = np.atleast_1d(np.asarray(x, dtype=float)), np.atleast_1d(np.asarray(y, dtype=float))
        inside = (across > -0.5) & (across < self.width - 0.5) & (down > -0.5) & (down < self.height - 0.5)
        columns, rows = np.rint(across[inside]).astype(np.intp), np.rint(down[inside]).astype(np.intp)
        self._dots[rows, columns] = 1
        self._tones[rows >> 2, columns >> 1] = tone

    def line(self, x: ArrayLike, y: ArrayLike, tone: Tone, gap: int = 1) -> None:
        """Draw straight lines from point to point.

        Args:
            x: Dots from the left, shape (n,).
            y: Dots from the top, shape (n,).
            tone: Of their cells.
            gap: Only every so many dots, for dotted lines.
        """
        across, down = np.asarray(x, dtype=float).tolist(), np.asarray(y, dtype=float).tolist()
        for index in range(len(across) - 1):
            x0, y0, x1, y1 = across[index], down[index], across[index + 1], down[index + 1]
            begin, end = _within(x0, x1 - x0, self.width, *_within(y0, y1 - y0, self.height, 0.0, 1.0))
            if not begin <= end:
                continue
            count = max(round((end - begin) * max(abs(x1 - x0), abs(y1 - y0))), 1)
            share = begin + (end - begin) * np.arange(0, count + 1, gap) / count
            self.plot(x0 + (x1 - x0) * share, y0 + (y1 - y0) * share, tone)

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
        blocks = self._dots.reshape(self.rows, 4, self.columns, 2)
        bits = cast("NDArray[np.uint32]", np.einsum("ricj,ij->rc", blocks, _BITS))
        written = self._letters != 0
        codes = np.where(written, self._letters, np.where(bits == 0, _SPACE, _BRAILLE + bits))
        tones = np.where(codes == _SPACE, 0, np.where(written, self._letter_tones, self._tones))
        return [_runs(codes[row], tones[row]) for row in range(self.rows)]


def _within(start: float, way: float, size: int, begin: float, end: float) -> tuple[float, float]:
    """Return which part of a way lies within a size (Liang and Barsky, 1984); none where the first is larger."""
    if not (math.isfinite(start) and math.isfinite(way)):
        return 1.0, 0.0
    if abs(way) < 1e-9:
        return (begin, end) if -1 <= start <= size else (1.0, 0.0)
    first, last = sorted(((-1 - start) / way, (size - start) / way))
    return max(begin, first), min(end, last)


def _runs(codes: NDArray[np.uint32], tones: NDArray[np.uint8]) -> Row:
    text = codes.astype("<u4").tobytes().decode("utf-32-le")
    edges = [0, *(np.flatnonzero(np.diff(tones)) + 1).tolist(), len(text)]
    kinds = tones[edges[:-1]].tolist()
    return [(text[edges[i] : edges[i + 1]], Tone(kinds[i])) for i in range(len(kinds))]
