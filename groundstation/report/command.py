"""`groundstation report`: one flight, several compared, a class, or the paper's experiments."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from groundstation.errors import InputError
from groundstation.progress.opening import store_in
from groundstation.report import paper
from groundstation.report.document import Report
from groundstation.report.files import files_of, tell, write
from groundstation.review.choosing import chosen
from groundstation.review.flight import Flight
from groundstation.review.listing import list_flights
from groundstation.status_line import StatusLine


def run(asked: argparse.Namespace) -> int:
    """Write what was asked for and return the exit code.

    Raises:
        InputError: A recording cannot be read, or a file not be written.
    """
    if asked.mission and not asked.group:
        raise InputError("--mission chooses the flights of a --class; add it.")
    if asked.paper:
        if asked.flights:
            raise InputError("--paper flies its own flights; leave the recordings out.")
        return paper.report(asked.out or Path("paper.html"), asked.seed, pdf=asked.pdf)
    if asked.compare:
        return _compare(asked)
    return _class(asked) if asked.group else _flight(asked)


def _flight(asked: argparse.Namespace) -> int:
    from groundstation.report.flight_report import report_on, summarised

    if len(asked.flights) > 1:
        raise InputError("a report is on one flight; --compare sets several side by side.")
    path = chosen(asked.flights[0] if asked.flights else None, asked.logs)
    files = files_of(asked.out or path.with_suffix(".html"), with_pdf=asked.pdf)
    return _done(report_on(summarised(Flight(path))), files)


def _compare(asked: argparse.Namespace) -> int:
    from groundstation.report.comparison import MOST, report_on
    from groundstation.report.flight_report import summarised

    if not 2 <= len(asked.flights) <= MOST:
        raise InputError(f"--compare sets 2 to {MOST} flights side by side; name them.")
    paths = [chosen(named, asked.logs) for named in asked.flights]
    files = files_of(asked.out or Path("comparison.html"), with_pdf=asked.pdf)
    return _done(report_on([summarised(Flight(path)) for path in paths]), files)


def _class(asked: argparse.Namespace) -> int:
    return _recorded_class(asked) if asked.flights or not store_in(asked.logs).exists() else _school(asked)


def _school(asked: argparse.Namespace) -> int:
    """Sum up a class from the store of progress, which knows what each pilot has learned."""
    from groundstation.progress.desk import Desk
    from groundstation.progress.store import Store
    from groundstation.report.classroom import kept, report_on

    files = files_of(asked.out or Path("class.html"), with_pdf=asked.pdf)
    with Store(store_in(asked.logs)) as store:
        broken = [store.words] if store.words else []
        flights = [each for each in store.flights() if asked.mission in (None, each.mission)]
    if not flights:
        raise InputError(f"{asked.logs}: there are no such flights to sum up; see 'groundstation progress'.")
    desk = Desk(asked.logs)
    names = sorted({each.pilot for each in flights}, key=str.casefold)
    standings = {name: desk.report(name).standing for name in names}
    return _done(report_on([kept(each) for each in flights], broken, standings), files)


def _recorded_class(asked: argparse.Namespace) -> int:
    from groundstation.report.classroom import Flown, flown, report_on

    paths = [chosen(named, asked.logs) for named in asked.flights]
    paths = paths or [entry.path for entry in list_flights(asked.logs)]
    files = files_of(asked.out or Path("class.html"), with_pdf=asked.pdf)
    found: list[Flown] = []
    broken: list[str] = []
    with StatusLine(sys.stderr) as line:
        for number, path in enumerate(paths, 1):
            line.step(f"reading {number} of {len(paths)}: {path.name}")
            try:
                found.append(flown(Flight(path)))
            except InputError as error:
                broken.append(str(error))
    found = [each for each in found if asked.mission in (None, each.mission)]
    if not found:
        raise InputError(
            f"{asked.logs}: there are no such flights to sum up; see 'groundstation review --list'."
        )
    return _done(report_on(found, broken), files)


def _done(report: Report, files: Sequence[Path]) -> int:
    write(report, files)
    tell(report.findings, files)
    return 0
