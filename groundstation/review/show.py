"""`groundstation review`: the flights there are, and one of them in the Rerun viewer."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from groundstation.errors import InputError
from groundstation.recording.live import free_tcp_port, has_display, page_address
from groundstation.recording.parts import is_growing, parts_of
from groundstation.recording.program import ENVIRONMENT, LOOPBACK, program
from groundstation.review.choosing import chosen
from groundstation.review.table import list_all

# A flight is looked at whole: data that do not fit drop out, the oldest first.
_MEMORY = ("--memory-limit", "75%", "--server-memory-limit", "2GB")

# One view has room for so many flights.
_MOST = 2

Spawn = Callable[[Sequence[str]], int]


def run(asked: argparse.Namespace) -> int:
    """Do what was asked and return the exit code.

    Raises:
        InputError: There is no such recording, or no way to show it.
    """
    if asked.list:
        return list_all(asked.logs, mission=asked.mission, pilot=asked.pilot, as_json=asked.json)
    if len(asked.flights) > _MOST:
        raise InputError("two flights fit in one view; 'report --compare' takes more.")
    paths = [chosen(named, asked.logs) for named in asked.flights] or [chosen(None, asked.logs)]
    if len(paths) == 1:
        if asked.out:
            raise InputError("--out keeps the comparison of two flights; name two.")
        return tell(paths[0]) if asked.score else review(paths[0], asked.at, web=asked.web)
    if asked.score or asked.at is not None:
        raise InputError("--score and --at are for one flight; name one.")
    return compare(paths, asked.out, web=asked.web)


def tell(path: Path) -> int:
    """Print a flight's score with its parts, and where points were lost; return the exit code: 1 where not passed.

    Raises:
        InputError: There is no such recording, or it is of no mission.
    """
    from groundstation.review.flight import Flight
    from groundstation.review.outcome import outcome_of
    from groundstation.review.sights import origin
    from groundstation.training.telling import told

    flight = Flight(path)
    outcome = outcome_of(flight)
    if outcome.judgement is None:
        raise InputError(f"{path}: {outcome.result}; there is nothing to be scored.")
    facts = flight.properties()
    print(f"{str(facts.get('mission', '')) or 'flight'}: {outcome.result}")
    print("\n".join(told(outcome.judgement, str(facts.get("par_from", "")), origin(flight))))
    return 1 if outcome.completed is False else 0


def compare(paths: Sequence[Path], out: Path | None, *, web: bool = False) -> int:
    """Open two recordings in one view and wait until it is closed; return the exit code.

    Args:
        paths: Of the two.
        out: Where the comparison is kept; None for not at all.
        web: In a browser on this machine instead of a window.

    Raises:
        InputError: A recording cannot be read, or there is no way to show them.
    """
    from groundstation.review.comparison import write_comparison

    if out is not None:
        if out.suffix != ".rrd" or not out.parent.is_dir():
            raise InputError(f"{out}: name an .rrd file in a folder that is there.")
        write_comparison(paths, out)
        print(out)
        return review(out, web=web) if web or has_display(os.environ) else 0
    with tempfile.TemporaryDirectory(prefix="groundstation-compare-") as folder:
        path = Path(folder) / f"{paths[0].stem} and {paths[1].stem}.rrd"
        write_comparison(paths, path)
        return review(path, web=web)


def review(
    log: Path,
    at: float | None = None,
    *,
    web: bool = False,
    environment: Mapping[str, str] = os.environ,
    spawn: Spawn | None = None,
) -> int:
    """Open a recording in the viewer and wait until it is closed.

    Args:
        log: The recording. One that did not end properly is put in order first.
        at: Time of the recording to begin at, s; None for where the viewer begins.
        web: In a browser on this machine instead of a window.
        environment: Tells whether there is a display.
        spawn: Runs a command and returns its exit code.

    Returns:
        The exit code.

    Raises:
        InputError: There is no such recording, or no way to show it.
    """
    parts = parts_of(log)
    for part in parts:
        _put_in_order(part)
    if not web and not has_display(environment):
        raise InputError("there is no display to open the viewer on; look in a browser with --web.")
    port = free_tcp_port()
    command = [str(program()), *LOOPBACK, "--port", str(port), *_MEMORY]
    if web:
        page_port = free_tcp_port()
        command += ["--serve-web", "--web-viewer-port", str(page_port)]
        page = page_address(page_port, f"rerun+http://127.0.0.1:{port}/proxy")
        # A page cannot be told from here where to begin.
        moment = "" if at is None else f"The moment is at {at:.1f} s on its time panel.\n"
        sys.stderr.write(f"{log.name} is at {page}\n{moment}Ctrl-C ends.\n")
    elif at is not None:
        # The viewer has no option for it; it is told once it has loaded the file.
        threading.Thread(target=_go_to, args=(port, at), name="jump", daemon=True).start()
    return (spawn or _run)([*command, *(str(part.resolve()) for part in parts)])


def _put_in_order(log: Path) -> None:
    from groundstation.review.rrd import is_whole, mend, open_reader

    if is_whole(open_reader(log)):
        return
    if is_growing(log):
        sys.stderr.write(f"{log.name} is still being recorded: this is the flight so far.\n")
        return
    sys.stderr.write(f"{log.name} did not end properly: putting it in order.\n")
    mend(log)


def _go_to(port: int, at: float) -> None:
    from groundstation.review.jump import go_to

    go_to(port, at)


def _run(command: Sequence[str]) -> int:
    try:
        return subprocess.call(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, **ENVIRONMENT},
        )
    except KeyboardInterrupt:
        return 0
