"""A report's files: checked before there is work, written, and told on the terminal."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from groundstation.errors import InputError
from groundstation.report import pdf
from groundstation.report.document import Finding, Report, page


def files_of(out: Path, *, with_pdf: bool) -> list[Path]:
    """Return the files of a report: the page, and the PDF beside it if it is wanted.

    Raises:
        InputError: One cannot be written.
    """
    if out.suffix.lower() == ".pdf":
        raise InputError(f"{out}: the page is HTML; name an .html file, --pdf writes the PDF beside it.")
    files = [out, out.with_suffix(".pdf")] if with_pdf else [out]
    for file in files:
        try:
            if file.exists():
                file.open("ab").close()
            else:
                tempfile.TemporaryFile(dir=file.parent).close()
        except OSError as error:
            raise _unwritable(file, error) from error
    return files


def write(found: Report, files: Sequence[Path]) -> None:
    """Write a report.

    Raises:
        InputError: A file cannot be written.
    """
    html_file, *documents = files
    try:
        html_file.write_text(page(found), encoding="utf-8")
        for document in documents:
            pdf.save(found, document)
    except OSError as error:
        raise _unwritable(Path(error.filename or html_file), error) from error


def tell(findings: Sequence[Finding], files: Sequence[Path]) -> None:
    """Print the table, and where the report is."""
    cells = [(*finding[:4], finding.verdict) for finding in findings]
    widths = [max(len(row[column]) for row in cells) for column in range(4)] if cells else []
    for row in cells:
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))
        sys.stdout.write(f"{line}  {row[4]}".rstrip() + "\n")
    sys.stdout.write("".join(f"{file}\n" for file in files))


def _unwritable(file: Path, error: OSError) -> InputError:
    return InputError(f"{file}: cannot be written ({error.strerror}); choose another --out.")
