"""`groundstation export`: checks what is asked for, reads the recording, writes it, says what is where."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from groundstation.errors import InputError
from groundstation.export import folder
from groundstation.export.output import check, written
from groundstation.export.selection import Asked, Selection
from groundstation.review.choosing import chosen
from groundstation.review.flight import Flight
from groundstation.status_line import StatusLine


def run(asked: argparse.Namespace) -> int:
    """Export a flight and return the exit code.

    Raises:
        InputError: The recording cannot be read, nothing is left of it, or there is nowhere to write.
    """
    what = _asked(asked)
    path = chosen(asked.flight, asked.logs)
    outs = _outs(asked, path)
    in_folder = asked.to != "mcap" and asked.hz is None
    for out in outs:
        check(out, folder=in_folder, force=asked.force)
    with StatusLine(sys.stderr) as line:
        line.step(f"reading {path}")
        selection = Selection(Flight(path), what)
        if selection.unknown:
            line.note(f"Left out, not known to this program: {', '.join(selection.unknown)}.")
        for out in outs:
            with written(out, folder=in_folder, force=asked.force) as draft:
                _write(selection, asked, draft, out, line)
    for out in outs:
        print(f"{out} ({_size(out) / 1e6:.1f} MB)")
    return 0


def _asked(asked: argparse.Namespace) -> Asked:
    start = -math.inf if asked.start is None else asked.start
    end = math.inf if asked.end is None else asked.end
    if not start <= end:
        raise InputError(
            f"--start {start:g}: is after --end {end:g}; both are seconds since the run's start."
        )
    if asked.hz is not None and not 0.0 < asked.hz < math.inf:
        raise InputError(f"--hz {asked.hz:g}: is not a rate; give rows a second, above 0.")
    if asked.hz is not None and asked.to == "mcap":
        raise InputError(
            "--hz makes one wide table, and an MCAP file holds none; leave it out, or use --to csv."
        )
    return Asked(tuple(asked.entities or ()), start, end)


def _outs(asked: argparse.Namespace, recording: Path) -> list[Path]:
    """Return what to write: a folder, an MCAP file, or a wide table and what its columns mean."""
    if asked.to == "mcap" or asked.hz is not None:
        out = asked.out or recording.with_suffix(f".{asked.to}")
        return [out] if asked.to != "csv" else [out, out.with_suffix(f".{folder.COLUMNS}.csv")]
    return [asked.out or recording.with_name(f"{recording.stem}_{asked.to}")]


def _write(selection: Selection, asked: argparse.Namespace, draft: Path, out: Path, line: StatusLine) -> None:
    """Write one of the outputs."""
    if asked.to == "mcap":
        from groundstation.export.mcap_file import write_mcap

        line.tell(f"writing {out}")
        write_mcap(selection, draft, lambda words: line.step(f"writing {out}: {words}"))
    elif asked.hz is None:
        line.tell(f"writing {out}")
        folder.write_folder(selection, draft, asked.to, lambda words: line.step(f"writing {out}: {words}"))
    elif out.name.endswith(f".{folder.COLUMNS}.csv"):
        folder.save(folder.described(selection, in_one=True), draft, "csv")
    else:
        line.tell(f"writing {out}")
        folder.write_wide(selection, draft, asked.hz, asked.to)


def _size(out: Path) -> int:
    files = [out] if out.is_file() else out.iterdir()
    return sum(file.stat().st_size for file in files)
