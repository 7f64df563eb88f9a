"""`groundstation evaluate`: reads the axes, flies what is missing, writes table and figure, says what differs."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Generator, Sequence
from contextlib import closing
from pathlib import Path

from groundstation import config
from groundstation.errors import InputError
from groundstation.evaluation import figure, grid, words
from groundstation.evaluation.axes import read_axes
from groundstation.evaluation.case import Result, Task
from groundstation.evaluation.progress import Progress
from groundstation.evaluation.store import CSV, LOG, PARQUET, Log, write_table
from groundstation.evaluation.trial import fly
from groundstation.evaluation.work import WorkError, fly_here, processes

EXIT_STOPPED, EXIT_FAILED = 130, 1
FIGURE = ".svg"


def evaluate(asked: argparse.Namespace) -> int:
    """Do what was asked for and return the exit code.

    Raises:
        InputError: An axis, the settings, the output or the cluster cannot be used.
    """
    out = _output(asked.out)
    settings = config.load_settings(asked.config)
    config.check_flown_by_rate(settings)
    tasks = grid.tasks(read_axes(asked), settings)
    log = Log(out.with_suffix(LOG))
    try:
        why, code = _fly(tasks, log, asked)
    finally:
        log.close()
    results = [log.results[task.id] for task in tasks if task.id in log.results]
    if why:
        print(
            f"{why}: {len(results)} of {len(tasks)} flights are kept in {log.path}; the same command flies the rest.",
            file=sys.stderr,
        )
        return code
    try:
        write_table(out, results)
        figure.draw(out.with_suffix(FIGURE), results)
    except OSError as error:
        raise InputError(
            f"{error.filename or out}: cannot be written ({error.strerror}); the flights are kept in {log.path}, "
            "so give the same command again when it can."
        ) from error
    print(words.comparison(results, shutil.get_terminal_size((110, 24)).columns))
    print(f"\ntable {out}, figure {out.with_suffix(FIGURE)}")
    return 0


def _fly(tasks: Sequence[Task], log: Log, asked: argparse.Namespace) -> tuple[str, int]:
    """Fly what the log does not have yet; return why that ended early, or "", and the exit code."""
    missing = [task for task in tasks if task.id not in log.results]
    if not missing:
        return "", 0
    flights = _flights(missing, asked)
    try:
        with closing(flights), Progress(len(tasks), len(tasks) - len(missing), sys.stderr) as progress:
            for result in flights:
                log.add(result)
                log.results[result.id] = result
                progress.add(result.outcome.flown)
    except KeyboardInterrupt:
        return "stopped", EXIT_STOPPED
    except WorkError as error:
        return str(error), EXIT_FAILED
    except OSError as error:
        return f"{log.path} cannot be written any more ({error.strerror})", EXIT_FAILED
    return "", 0


def _flights(tasks: Sequence[Task], asked: argparse.Namespace) -> Generator[Result]:
    if asked.cluster is not None:
        from groundstation.evaluation.cluster import fly_on_cluster

        return fly_on_cluster(tasks, asked.cluster)
    return fly_here(fly, tasks, processes(asked.jobs, len(tasks)))


def _output(path: Path) -> Path:
    """See that there is a place for the table."""
    if path.suffix not in (PARQUET, CSV):
        raise InputError(
            f"--out {path}: ends in neither {PARQUET} nor {CSV}; the suffix says what is written."
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {path}: its folder cannot be made ({error.strerror}).") from error
    if path.is_dir():
        raise InputError(f"--out {path}: is a folder; give a file.")
    return path
