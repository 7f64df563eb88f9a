"""`groundstation report --paper`: the paper's experiments flown anew, and its figures 9 to 13 drawn from them."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TextIO

from groundstation.report.files import files_of, tell, write
from groundstation.report.paper_flights import Watcher, fly_all, paper_mission
from groundstation.report.paper_report import report_on
from groundstation.training.director import Director
from groundstation.training.mission import Mission

_TELL_EVERY_S = 0.2


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
    progress = _Progress(sys.stderr)
    flights = fly_all(
        mission or paper_mission(), seed, lambda conditions: progress.of(f"flying {conditions}")
    )
    progress.tell("drawing")
    found = report_on(flights, seed)
    try:
        write(found, files)
    finally:
        progress.close()
    tell(found.findings, files)
    return 0 if found.holds else 1


class _Progress:
    """Tells how it is going: on a terminal one line that changes, else a line a step.

    Args:
        out: Where to.
    """

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._live = out.isatty()
        self._next = 0.0

    def tell(self, words: str) -> None:
        """Tell what is begun."""
        self._out.write(f"\r\x1b[K{words}" if self._live else f"{words}\n")
        self._out.flush()

    def of(self, words: str) -> Watcher:
        """Tell that a flight begins, and return who tells how it goes on."""
        self.tell(words)

        def watch(director: Director) -> None:
            now = time.monotonic()
            if self._live and now >= self._next:
                self._next = now + _TELL_EVERY_S
                left = director.target_distance()
                self.tell(f"{words}: {director.stage.value}, {left:.1f} m to the target")

        return watch

    def close(self) -> None:
        """End the changing line."""
        if self._live:
            self._out.write("\r\x1b[K")
            self._out.flush()
