"""`groundstation report --paper`: the paper's experiments flown anew, and its figures 9 to 13 drawn from them."""

from __future__ import annotations

import sys
from pathlib import Path

from groundstation.report.files import files_of, tell, write
from groundstation.report.paper_flights import Watcher, fly_all, paper_mission
from groundstation.report.paper_report import report_on
from groundstation.status_line import StatusLine
from groundstation.training.director import Director
from groundstation.training.mission import Mission


def report(out: Path, seed: int, *, pdf: bool, mission: Mission | None = None) -> int:
    """Fly, draw, write the page, and print the table.

    Args:
        out: The page's file.
        seed: Of all that is random in the flights.
        pdf: Write the same as a PDF beside it.
        mission: Another than the paper's, with a target.

    Returns:
        The exit code: 0 when every bar holds, else 1.

    Raises:
        InputError: A file cannot be written there.
    """
    files = files_of(out, with_pdf=pdf)
    with StatusLine(sys.stderr) as line:
        flights = fly_all(
            mission or paper_mission(), seed, lambda conditions: _watching(line, f"flying {conditions}")
        )
        line.tell("drawing")
        found = report_on(flights, seed)
        write(found, files)
    tell(found.findings, files)
    return 0 if found.holds else 1


def _watching(line: StatusLine, words: str) -> Watcher:
    """Tell that a flight begins, and return who tells how it goes on."""
    line.tell(words)

    def watch(director: Director) -> None:
        line.step(f"{words}: {director.stage.value}, {director.target_distance():.1f} m to the target")

    return watch
