"""`groundstation progress`: how pilots come along, told, printed, filled in and forgotten."""

from __future__ import annotations

import argparse
import datetime
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from groundstation.errors import InputError
from groundstation.login import login_name
from groundstation.progress.flown import Flown
from groundstation.progress.opening import store_in
from groundstation.progress.overview import aligned, everybody, fields, table
from groundstation.progress.skills import standing_of
from groundstation.progress.store import Store
from groundstation.progress.words import hours
from groundstation.training.curriculum import lessons


def run(asked: argparse.Namespace) -> int:
    """Do what was asked and return the exit code.

    Raises:
        InputError: The store cannot be used, or there is no such pilot.
    """
    acts = {"pilots": _pilots, "certificate": _certificate, "import": _import, "forget": _forget}
    return acts.get(asked.act, _show)(asked)


def _show(asked: argparse.Namespace) -> int:
    pilot = asked.pilot or login_name()
    flights = _flights(asked.logs, pilot, must_be=asked.pilot is not None)
    # As it was written first.
    pilot = flights[0].pilot if flights else pilot
    today = datetime.datetime.now().astimezone().date()
    standing = standing_of([lesson.mission for lesson in lessons()], flights, today)
    if asked.json:
        print(json.dumps(fields(pilot, standing, flights, today)))
    else:
        print(table(pilot, standing, flights, today))
    return 0


def _pilots(asked: argparse.Namespace) -> int:
    found = everybody(_read(asked.logs))
    if asked.json:
        print(json.dumps({name: career._asdict() for name, career in found.items()}))
    elif not found:
        print(f"Nobody has flown a mission yet, as far as {asked.logs} tells.")
    else:
        rows: list[tuple[str, ...]] = [("pilot", "flights", "time", "passed", "last flown")]
        for name, (flights, seconds, passed, last) in found.items():
            rows.append((name, f"{flights}", hours(seconds), f"{passed}", last))
        print("\n".join(aligned(rows)))
    return 0


def _certificate(asked: argparse.Namespace) -> int:
    from groundstation.progress.certificate import write

    out = asked.out or Path("certificate.html")
    flights = _flights(asked.logs, asked.name, must_be=True)
    write(flights, [lesson.mission for lesson in lessons()], out)
    print(out)
    return 0


def _import(asked: argparse.Namespace) -> int:
    from groundstation.progress.importing import import_flights

    if not asked.files and not asked.logs.is_dir():
        raise InputError(f"{asked.logs}: there is no such folder; choose one with recordings by --logs.")
    asked.logs.mkdir(parents=True, exist_ok=True)
    with _open(asked.logs) as store:
        return import_flights(store, asked.files, asked.logs)


def _forget(asked: argparse.Namespace) -> int:
    from groundstation.progress.forgetting import forget

    flights = _flights(asked.logs, asked.name, must_be=True)
    with _open(asked.logs) as store:
        return forget(store, flights, asked.logs, sure=asked.yes)


def _flights(folder: Path, pilot: str, *, must_be: bool) -> Sequence[Flown]:
    """Return a pilot's flights.

    Raises:
        InputError: There are none although there must be.
    """
    everything = _read(folder)
    theirs = [each for each in everything if each.pilot.casefold() == pilot.casefold()]
    if must_be and not theirs:
        known = ", ".join(sorted({each.pilot for each in everything}, key=str.casefold)) or "nobody"
        raise InputError(f"{pilot}: has no flights in {folder}; known: {known}.")
    return theirs


def _read(folder: Path) -> list[Flown]:
    """Return all flights; to read makes no file where there is none.

    Raises:
        InputError: It is no folder, or its store cannot be read.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is no folder; choose one with recordings by --logs.")
    if not store_in(folder).exists():
        return []
    with _open(folder) as store:
        return store.flights()


def _open(folder: Path) -> Store:
    store = Store(store_in(folder))
    if store.words:
        print(f"groundstation: {store.words}", file=sys.stderr)
    return store
