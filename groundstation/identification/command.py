"""`groundstation identify`: reads flights, identifies, validates, says what was found and writes it."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence

from groundstation.errors import InputError
from groundstation.identification import words
from groundstation.identification.fit import Identified, Told, identify, told
from groundstation.identification.preset import write_preset
from groundstation.identification.samples import Samples
from groundstation.identification.sources import read_flight


def run(asked: argparse.Namespace) -> int:
    """Do what was asked for and return the exit code.

    Raises:
        InputError: A flight cannot be used, or a file not be written.
    """
    learned = [read_flight(path) for path in asked.flights]
    unseen = [read_flight(path) for path in asked.validate]
    found = identify(learned, _tell)
    _tell("")
    flights = [*learned, *unseen]
    tolds = [told(found, flight) for flight in flights]
    names = [flight.name for flight in learned]
    if asked.json:
        print(json.dumps(words.as_json(found, tolds)))
    else:
        print(words.table(found, tolds, names))
    if asked.out:
        write_preset(asked.out, asked.name or asked.out.stem, asked.like, found, tolds)
        print(f"\n{asked.out}: fly it with --sim --airframe {asked.out} --model dynamic", file=sys.stderr)
    if asked.page:
        _write_page(asked, found, flights, tolds, names)
    return 0


def _write_page(
    asked: argparse.Namespace,
    found: Identified,
    flights: Sequence[Samples],
    tolds: Sequence[Told],
    names: Sequence[str],
) -> None:
    from groundstation.identification.figures import report_on
    from groundstation.report.document import page

    try:
        asked.page.write_text(page(report_on(found, flights, tolds, names)), encoding="utf-8")
    except OSError as error:
        raise InputError(
            f"{asked.page}: cannot be written ({error.strerror}); choose another --page."
        ) from error
    print(asked.page, file=sys.stderr)


def _tell(step: str) -> None:
    """Say what is being done, on a terminal in one line that changes."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r\x1b[K{step}")
        sys.stderr.flush()
