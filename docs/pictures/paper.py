"""Take docs/images/paper-figures.png: four of the report's figures, from the flights that the command flies.

python docs/pictures/paper.py [FILE.png]
"""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path

from matplotlib.figure import Figure

from groundstation.report.document import WIDTH, Plate
from groundstation.report.figures import style
from groundstation.report.paper_flights import fly_all, paper_mission
from groundstation.report.paper_report import report_on

ROOT = Path(__file__).resolve().parents[2]
COLUMNS = (("Figure 10", "Beyond figure 11"), ("Figure 11", "Figure 12"))
TITLE, LETTERS, DPI = 0.45, 84, 110


def draw(plates: dict[str, Plate]) -> Figure:
    """Draw the figures in two columns, each under its title."""
    heights = [[plates[name].height + TITLE for name in column] for column in COLUMNS]
    figure = Figure(figsize=(2.0 * WIDTH, max(map(sum, heights))), layout="constrained")
    for column, names, ratios in zip(figure.subfigures(1, 2, wspace=0.03), COLUMNS, heights, strict=True):
        for part, name in zip(column.subfigures(2, 1, height_ratios=ratios), names, strict=True):
            title = textwrap.fill(f"{name}. {plates[name].title}", LETTERS)
            part.suptitle(title, x=0.03, ha="left", fontsize=10.0, fontweight="bold")
            plates[name].draw(part)
    return figure


def main() -> None:
    """Fly, and take it."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images" / "paper-figures.png"
    found = report_on(fly_all(paper_mission(), 0, lambda _: lambda _: None), 0)
    with style.applied():
        draw({plate.name: plate for plate in found.plates}).savefig(out, dpi=DPI)
    print(out)


if __name__ == "__main__":
    main()
