"""Flies tasks on this machine, in processes of their own, one flight at a time each."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from groundstation.errors import InputError

Task = TypeVar("Task")
Result = TypeVar("Result")

# Tasks handed out ahead for each process: none waits for the next.
_AHEAD = 2


class WorkError(Exception):
    """The work cannot go on; the message says why, in one sentence."""


def processes(asked: int | None, tasks: int) -> int:
    """Return how many processes fly so many tasks: as many as were asked for, else as there are cores.

    Raises:
        InputError: It is no number of processes.
    """
    jobs = (os.cpu_count() or 1) if asked is None else asked
    if jobs < 1:
        raise InputError(f"--jobs {jobs}: is not a number of processes; give 1 or more.")
    return min(jobs, tasks)


def fly_here(fly: Callable[[Task], Result], tasks: Sequence[Task], jobs: int) -> Generator[Result]:
    """Yield results as flights end. Closing the iterator stops the flights under way.

    Args:
        fly: Flies a task to its end; what it raises ends the work.
        tasks: What to fly.
        jobs: How many processes.

    Raises:
        WorkError: A process was killed.
    """
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _begin)
    ahead = iter(tasks)
    try:
        flying = {pool.submit(fly, task) for task in itertools.islice(ahead, _AHEAD * jobs)}
        while flying:
            ended: set[Future[Result]]
            ended, flying = wait(flying, return_when=FIRST_COMPLETED)
            flying |= {pool.submit(fly, task) for task in itertools.islice(ahead, len(ended))}
            for future in ended:
                yield future.result()
        # Nothing is under way: the processes end by themselves, and none is told so that has gone already.
        pool.shutdown()
    except BrokenProcessPool as error:
        raise WorkError("a process that was flying was killed, perhaps for want of memory") from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in multiprocessing.active_children():
            child.terminate()


def _begin() -> None:
    """Leave Ctrl-C to the parent, and end with it, however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
    os._exit(1)
