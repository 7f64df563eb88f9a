"""`groundstation identify`: reads flights, identifies, validates, says what was found and writes it."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from msgspec.structs import astuple

from groundstation.errors import InputError
from groundstation.identification import preset, words
from groundstation.identification.findings import Findings
from groundstation.identification.fit import identify
from groundstation.identification.matrix import each_on_each
from groundstation.identification.response import LONGEST_DELAY_S
from groundstation.identification.samples import Samples, on_grid, step_of
from groundstation.identification.sources import read_flight
from groundstation.identification.validate import validated
from groundstation.status_line import StatusLine


def run(asked: argparse.Namespace) -> int:
    """Do what was asked for and return the exit code.

    Raises:
        InputError: A flight cannot be used, or a file not be written.
    """
    _check(asked)
    with StatusLine(sys.stderr) as line:
        found = _found(asked, line)
        if asked.out:
            preset.write(asked.out, asked.name or asked.out.stem, asked.like, found)
        if asked.report:
            line.tell("drawing")
            _write_report(asked.report, found)
    print(json.dumps(words.as_json(found), allow_nan=False) if asked.json else words.table(found))
    if asked.out:
        print(f"{asked.out}: fly it with --sim --model dynamic --airframe {asked.out}", file=sys.stderr)
        if missing := words.missing_delay(found):
            print(missing, file=sys.stderr)
    if asked.report:
        print(asked.report, file=sys.stderr)
    return 0


def _check(asked: argparse.Namespace) -> None:
    """Say what is wrong with a file that shall be written before anything is computed for it."""
    for option, path, suffix in (("--out", asked.out, ".toml"), ("--report", asked.report, ".html")):
        if path is None:
            continue
        if path.suffix.lower() != suffix:
            raise InputError(f"{option} {path}: give a name that ends in {suffix}.")
        if not path.parent.is_dir():
            raise InputError(
                f"{option} {path}: there is no folder {path.parent}; make it, or choose another."
            )
    if asked.out:
        preset.check(asked.out)
    preset.like(asked.like)


def _found(asked: argparse.Namespace, line: StatusLine) -> Findings:
    """Return all that the flights say."""
    compared = preset.chi_of(asked.compare) if asked.compare else None
    learned, unseen = _read([*asked.flights, *asked.validate], len(asked.flights), line)
    longest = 0.0 if asked.no_delay else LONGEST_DELAY_S
    identified = identify(learned, line.tell, longest)
    flights = [*learned, *unseen]
    line.tell("validating")
    of = identified.parameters
    validations = [validated(of.chi, of.delays, flight) for flight in flights]
    others = None
    if compared is not None:
        chi = np.array(astuple(compared))
        others = [validated(chi, np.zeros(3), flight) for flight in flights]
    matrix = each_on_each(learned, longest, line.tell) if len(learned) > 1 else None
    return Findings(identified, learned, flights, validations, matrix, asked.compare, compared, others)


def _read(paths: list[Path], learned: int, line: StatusLine) -> tuple[list[Samples], list[Samples]]:
    """Return the flights to learn from and the others, on the first one's step."""
    raws = []
    for path in paths:
        line.tell(f"reading {path.name}")
        raw = read_flight(path)
        if raw.damaged:
            line.note(f"{path}: is damaged; what could be read is used.")
        raws.append((path.name, raw))
    steps = [step_of(name, raw) for name, raw in raws]
    flights = [on_grid(name, raw, steps[0]) for name, raw in raws]
    return flights[:learned], flights[learned:]


def _write_report(path: Path, found: Findings) -> None:
    from groundstation.identification.figures import report_on
    from groundstation.report.document import page

    try:
        path.write_text(page(report_on(found)), encoding="utf-8")
    except OSError as error:
        raise InputError(f"--report {path}: cannot be written ({error.strerror}); choose another.") from error
