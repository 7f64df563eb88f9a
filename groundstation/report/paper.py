"""`groundstation report --paper`: the paper's experiments flown anew, and its figures 9 to 13 drawn from them."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from groundstation.errors import InputError
from groundstation.report import pdf
from groundstation.report.document import Finding, Report, page
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
    files = [out, out.with_suffix(".pdf")] if pdf else [out]
    _check(files)
    progress = _Progress(sys.stderr)
    flights = fly_all(
        mission or paper_mission(), seed, lambda conditions: progress.of(f"flying {conditions}")
    )
    progress.tell("drawing")
    found = report_on(flights, seed)
    try:
        _write(found, files)
    except OSError as error:
        raise _unwritable(out, error) from error
    finally:
        progress.close()
    _print(found.findings, files)
    return 0 if found.holds else 1


def _check(files: Sequence[Path]) -> None:
    """Say what is wrong with a path before anything is flown for it."""
    if files[0].suffix.lower() == ".pdf":
        raise InputError(f"{files[0]}: the page is HTML; name an .html file, --pdf writes the PDF beside it.")
    for file in files:
        try:
            if file.exists():
                file.open("ab").close()
            else:
                tempfile.TemporaryFile(dir=file.parent).close()
        except OSError as error:
            raise _unwritable(file, error) from error


def _unwritable(file: Path, error: OSError) -> InputError:
    return InputError(f"{file}: cannot be written ({error.strerror}); choose another --out.")


def _write(found: Report, files: Sequence[Path]) -> None:
    html_file, *documents = files
    html_file.write_text(page(found), encoding="utf-8")
    for document in documents:
        pdf.save(found, document)


def _print(findings: Sequence[Finding], files: Sequence[Path]) -> None:
    """Print the table, and where the report is."""
    cells = [(*finding[:4], finding.verdict) for finding in findings]
    widths = [max(len(row[column]) for row in cells) for column in range(4)]
    for row in cells:
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))
        sys.stdout.write(f"{line}  {row[4]}".rstrip() + "\n")
    sys.stdout.write("".join(f"{file}\n" for file in files))


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
