"""A report as a PDF: a page of words and numbers, then the figures, on A4."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from groundstation.report.document import WIDTH, Plate, Report, Table
from groundstation.report.figures import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Inches.
_PAGE = (8.27, 11.69)
_LEFT, _TOP = 0.5 * (_PAGE[0] - WIDTH), 0.7
_COLUMNS = (0.0, 0.75, 4.35, 5.55, 6.6)
_ROW, _BELOW_FIGURE, _BETWEEN = 0.19, 0.12, 0.3
# Points.
_SMALL, _BODY, _HEAD, _TITLE = 8.0, 9.0, 11.0, 16.0
# How many letters of a size in points fit a line, times that size.
_LETTERS = 920.0


class _Sheet:
    """An empty page that is written from its top down.

    Attributes:
        figure: The page.
        y: Where the next line goes, inches from the top.
    """

    def __init__(self) -> None:
        from matplotlib.figure import Figure

        self.figure: Figure = Figure(figsize=_PAGE)
        self.y = _TOP

    def write(
        self, words: str, size: float, *, colour: style.Colour = style.TEXT, bold: bool = False
    ) -> None:
        """Write a paragraph and move on below it."""
        y = self.y
        for line in _lines(words, size):
            self._put(0.0, y, line, size, colour, bold=bold)
            y += _line_height(size)
        self.y += _height(words, size)

    def row(self, cells: tuple[str, ...], *, colour: style.Colour = style.TEXT, bold: bool = False) -> None:
        """Write a line of the table."""
        for x, cell in zip(_COLUMNS, cells, strict=True):
            self._put(x, self.y, cell, _SMALL, colour, bold=bold)
        self.y += _ROW

    def cells(self, cells: Sequence[Sequence[str]], widths: Sequence[float], *, bold: bool) -> None:
        """Write a row of cells that are wrapped already."""
        x = 0.0
        for lines, width in zip(cells, widths, strict=True):
            for place, line in enumerate(lines):
                self._put(x, self.y + place * _line_height(_SMALL), line, _SMALL, style.TEXT, bold=bold)
            x += width
        self.y += len(max(cells, key=len)) * _line_height(_SMALL) + 0.3 * _SMALL / 72.0

    def _put(self, x: float, y: float, words: str, size: float, colour: style.Colour, *, bold: bool) -> None:
        self.figure.text(
            (_LEFT + x) / _PAGE[0], 1.0 - y / _PAGE[1], words, fontsize=size, color=colour, va="top",
            fontweight="bold" if bold else "normal", parse_math=False,
        )  # fmt: skip


def save(report: Report, path: Path) -> None:
    """Write the report.

    Raises:
        OSError: It cannot be written.
    """
    from matplotlib.backends.backend_pdf import PdfPages

    with style.applied(), PdfPages(path, metadata={"Title": report.title, "CreationDate": None}) as pages:
        pages.savefig(_front(report))
        for plates in _paged(report.plates):
            pages.savefig(_figures(plates))
        for sheet in _table_sheets(report.tables):
            pages.savefig(sheet)


def _front(report: Report) -> Figure:
    sheet = _Sheet()
    sheet.write(report.title, _TITLE, bold=True)
    for paragraph in report.lead:
        sheet.write(paragraph, _BODY)
    sheet.y += _ROW
    sheet.row(("", "quantity", "found", "bar", ""), bold=True)
    for finding in report.findings:
        sheet.row((*finding[:4], finding.verdict), colour=style.BAR if finding.holds is False else style.TEXT)
    sheet.y += _ROW
    for name, value in report.facts:
        sheet.write(f"{name}: {value}", _SMALL, colour=style.FAINT)
    return sheet.figure


def _table_sheets(tables: Sequence[Table]) -> Iterator[Figure]:
    """Yield the pages of the tables, one below the other; a row's cells are wrapped to their columns."""
    sheet: _Sheet | None = None
    for table in tables:
        widths = _widths(table)
        sheet = sheet or _Sheet()
        sheet.write(table.title, _HEAD, bold=True)
        if table.words:
            sheet.write(table.words, _SMALL, colour=style.FAINT)
        for row in (table.heads, *table.rows) if table.rows else ():
            cells = [_lines(cell, _SMALL, width) or [""] for cell, width in zip(row, widths, strict=True)]
            if sheet.y + len(max(cells, key=len)) * _line_height(_SMALL) > _PAGE[1] - _TOP:
                yield sheet.figure
                sheet = _Sheet()
            sheet.cells(cells, widths, bold=row is table.heads)
        sheet.y += _BETWEEN
    if sheet:
        yield sheet.figure


def _widths(table: Table) -> list[float]:
    """Return the columns' widths, inches, after the longest words in each, none wider than half the page."""
    longest = [
        max(len(row[column]) for row in (table.heads, *table.rows)) + 2 for column in range(len(table.heads))
    ]
    room = [min(letters, 50) for letters in longest]
    return [WIDTH * letters / max(sum(room), 60) for letters in room]


def _paged(plates: Sequence[Plate]) -> Iterator[list[Plate]]:
    """Yield the figures page by page, as many to one as have room."""
    page: list[Plate] = []
    y = _TOP
    for plate in plates:
        caption = _BELOW_FIGURE + _height(plate.caption, _BODY)
        needed = _height(_head(plate), _HEAD) + plate.height + caption + _BETWEEN
        if page and y + needed > _PAGE[1]:
            yield page
            page, y = [], _TOP
        page.append(plate)
        y += needed
    yield page


def _figures(plates: Sequence[Plate]) -> Figure:
    """Return a page with figures one below the other, each between its title and its caption."""
    sheet = _Sheet()
    edges = [0.0]
    for plate in plates:
        sheet.write(_head(plate), _HEAD, bold=True)
        edges += [sheet.y, sheet.y + plate.height]
        sheet.y += plate.height + _BELOW_FIGURE
        sheet.write(plate.caption, _BODY, colour=style.FAINT)
        sheet.y += _BETWEEN
    heights = [below - above for above, below in pairwise((*edges, _PAGE[1]))]
    sheet.figure.set_layout_engine("constrained")
    cells = sheet.figure.add_gridspec(
        len(heights), 3, width_ratios=[_LEFT, WIDTH, _LEFT], height_ratios=heights, wspace=0.0, hspace=0.0
    )
    for place, plate in enumerate(plates):
        plate.draw(sheet.figure.add_subfigure(cells[2 * place + 1, 1]))
    return sheet.figure


def _head(plate: Plate) -> str:
    return f"{plate.name}. {plate.title}"


def _lines(words: str, size: float, width: float = WIDTH) -> list[str]:
    return textwrap.wrap(words, max(4, int(_LETTERS / size * width / WIDTH)))


def _line_height(size: float) -> float:
    return 1.45 * size / 72.0


def _height(words: str, size: float) -> float:
    """Return the height of a paragraph with the room below it, inches."""
    return len(_lines(words, size)) * _line_height(size) + 0.6 * size / 72.0
