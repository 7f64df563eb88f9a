"""A report: what was found, as a table and as figures, in one HTML page that needs nothing else."""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Sequence
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from groundstation.report.figures import style

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

# Of a figure, inches: a text column of A4.
WIDTH = 7.1
_STYLE_SHEET = Path(__file__).with_name("document.css")


class Finding(NamedTuple):
    """A number that a report stands for.

    Attributes:
        where: The figure or equation it belongs to.
        what: In words.
        found: The number with its unit.
        bar: What it must be; "" where nothing is asked.
        holds: Whether it is; None where nothing is asked.
    """

    where: str
    what: str
    found: str
    bar: str = ""
    holds: bool | None = None

    @property
    def verdict(self) -> str:
        """In a word."""
        return {True: "holds", False: "FAILS", None: ""}[self.holds]


class Plate(NamedTuple):
    """A figure with its words.

    Attributes:
        name: "Figure 9".
        title: What is seen, in a sentence.
        caption: How to read it.
        height: Of the figure, inches.
        draw: Draws it on an empty figure.
    """

    name: str
    title: str
    caption: str
    height: float
    draw: Callable[[FigureBase], None]


class Table(NamedTuple):
    """A table with its words.

    Attributes:
        title: What it tells.
        words: How to read it; "" for nothing.
        heads: Of the columns.
        rows: A cell a column.
        folded: Shown only when asked for, where that is possible.
    """

    title: str
    words: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    folded: bool = False


class Report(NamedTuple):
    """What a report says, in its order.

    Attributes:
        title: Of the whole.
        lead: Paragraphs before all else.
        findings: The table.
        plates: The figures.
        facts: How it came about: pairs of name and value.
        tables: After the figures.
    """

    title: str
    lead: Sequence[str]
    findings: Sequence[Finding]
    plates: Sequence[Plate]
    facts: Sequence[tuple[str, str]]
    tables: Sequence[Table] = ()

    @property
    def holds(self) -> bool:
        """Whether nothing fails."""
        return all(finding.holds is not False for finding in self.findings)


def page(report: Report) -> str:
    """Return the report as an HTML page with its style and figures inside."""
    parts = [f"<h1>{_text(report.title)}</h1>"]
    parts += [f"<p>{_text(paragraph)}</p>" for paragraph in report.lead]
    parts.append(_table(report.findings))
    parts += [_figure(plate) for plate in report.plates]
    parts += [_other_table(table) for table in report.tables]
    facts = "".join(f"<dt>{_text(name)}</dt><dd>{_text(value)}</dd>" for name, value in report.facts)
    parts.append(f"<h2>How it was made</h2><dl>{facts}</dl>")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{_text(report.title)}</title>\n<style>\n{_STYLE_SHEET.read_text(encoding='utf-8')}</style>\n"
        "</head>\n<body>\n" + "\n".join(parts) + "\n</body>\n</html>\n"
    )


def _table(findings: Sequence[Finding]) -> str:
    rows = "".join(
        f'<tr class="{finding.verdict.lower()}">'
        + "".join(f"<td>{_text(cell)}</td>" for cell in (*finding[:4], finding.verdict))
        + "</tr>"
        for finding in findings
    )
    heads = "".join(f"<th>{head}</th>" for head in ("", "quantity", "found", "bar", ""))
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"


def _other_table(table: Table) -> str:
    heads = "".join(f"<th>{_text(head)}</th>" for head in table.heads)
    rows = "".join(f"<tr>{''.join(f'<td>{_text(cell)}</td>' for cell in row)}</tr>" for row in table.rows)
    words = f"<p>{_text(table.words)}</p>" if table.words else ""
    cells = f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>" if table.rows else ""
    inside = f"{words}{cells}"
    if table.folded:
        return f"<details><summary><h2>{_text(table.title)}</h2></summary>{inside}</details>"
    return f"<h2>{_text(table.title)}</h2>{inside}"


def _figure(plate: Plate) -> str:
    return (
        f"<figure><h2><span>{_text(plate.name)}</span> {_text(plate.title)}</h2>{_svg(plate)}"
        f"<figcaption>{_text(plate.caption)}</figcaption></figure>"
    )


def _svg(plate: Plate) -> str:
    """Return the figure as an SVG element that takes the width it is given."""
    from matplotlib.figure import Figure

    with style.applied():
        figure = Figure(figsize=(WIDTH, plate.height), layout="constrained")
        plate.draw(figure)
        file = StringIO()
        figure.savefig(file, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    element = file.getvalue()
    element = element[element.index("<svg") :]
    label = html.escape(f"{plate.name}: {plate.title}", quote=True)
    opening = rf'<svg \1 role="img" aria-label="{label}">'
    return re.sub(r'<svg [^>]*?(viewBox="[^"]*")[^>]*>', opening, element, count=1)


def _text(words: str) -> str:
    return html.escape(words, quote=False)
