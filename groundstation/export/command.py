"""`groundstation export`: a recording in another program's format."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from groundstation.errors import InputError
from groundstation.export.columns import Span
from groundstation.review.choosing import chosen
from groundstation.review.flight import Flight


def run(asked: argparse.Namespace) -> int:
    """Write what was asked for and return the exit code.

    Raises:
        InputError: The recording cannot be read, nothing of it was chosen, or the output cannot be written.
    """
    _check(asked)
    path = chosen(asked.flight, asked.logs)
    out = asked.out or path.with_suffix("" if _is_folder(asked) else f".{asked.to}")
    out = out.with_name(f"{out.name}_{asked.to}") if asked.out is None and _is_folder(asked) else out
    if out.exists() and not asked.force:
        raise InputError(f"{out}: is there already; choose another --out, or --force replaces it.")
    flight = Flight(path)
    span = Span(asked.only, asked.start, asked.end)
    if not any(span.chooses(entity) for entity in flight.entities):
        raise InputError(f"{path}: has no entity like {' '.join(asked.only)}; docs/logs.md lists them.")
    # Written under another name until it is whole: what was there stays, and nothing half is taken for whole.
    new = out.with_name(f".{out.name}.new")
    try:
        _remove(new)
        for words in _written(asked, flight, span, new):
            _progress(f"writing {words}")
        _remove(out)
        new.replace(out)
    except OSError as error:
        raise InputError(f"{out}: cannot be written ({error.strerror}); choose another --out.") from error
    finally:
        _progress("")
        _remove(new)
    print(out)
    return 0


def _check(asked: argparse.Namespace) -> None:
    if asked.hz is not None and not 0.0 < asked.hz <= 10_000.0:
        raise InputError(f"--hz {asked.hz:g}: is not a rate; give one above 0, up to 10000.")
    if asked.hz is not None and asked.to == "mcap":
        raise InputError("--hz makes one wide table, which MCAP has not; leave it out.")
    if asked.start > asked.end:
        raise InputError(f"--start {asked.start:g} is after --end {asked.end:g}.")


def _is_folder(asked: argparse.Namespace) -> bool:
    return asked.to != "mcap" and asked.hz is None


def _written(asked: argparse.Namespace, flight: Flight, span: Span, out: Path) -> Iterator[str]:
    if asked.to == "mcap":
        from groundstation.export.mcap_file import write_mcap

        return write_mcap(flight, span, out)
    from groundstation.export.tables import write_folder, write_wide

    if asked.hz is None:
        return write_folder(flight, span, out, asked.to)
    return write_wide(flight, span, out, asked.hz, asked.to)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _progress(words: str) -> None:
    """Say what is being done, on a terminal in one line that changes."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r\x1b[K{words}")
        sys.stderr.flush()
