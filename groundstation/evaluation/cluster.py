"""Flies tasks on a Dask.distributed cluster. `distributed` is the optional extra `cluster`, imported only here."""

from __future__ import annotations

import asyncio
import importlib.util
import itertools
import logging
from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING, cast

from groundstation import __version__
from groundstation.errors import InputError
from groundstation.evaluation.case import Result, Task
from groundstation.evaluation.trial import PRESET_NAMES, fly
from groundstation.evaluation.work import WorkError

if TYPE_CHECKING:
    from distributed import Client

CONNECT_S = 10.0
_AHEAD = 3
_EXTRA = "--cluster needs the extra 'cluster'; install it with: pip install 'groundstation[cluster]'."


def fly_on_cluster(tasks: Sequence[Task], address: str) -> Generator[Result]:
    """Yield results as flights end. Closing the iterator gives up the flights under way.

    Raises:
        InputError: The extra is not installed, nothing answers at the address, or its workers cannot fly.
        WorkError: The scheduler was lost.
    """
    try:
        from distributed import as_completed
        from distributed.client import FutureCancelledError
    except ImportError as error:
        raise InputError(_EXTRA) from error
    client = _connected(address)
    try:
        _send_controllers(client, tasks)
        ahead = iter(tasks)
        lanes = sum(cast("dict[str, int]", client.nthreads()).values())
        first = [_submit(client, task) for task in itertools.islice(ahead, _AHEAD * lanes)]
        flying = as_completed(first, loop=client.loop)
        for future in flying:
            result: Result = future.result()
            for task in itertools.islice(ahead, 1):
                flying.add(_submit(client, task))
            yield result
    except (FutureCancelledError, OSError) as error:
        raise WorkError(f"the scheduler at {address} was lost") from error
    finally:
        client.close()


def _connected(address: str) -> Client:
    """Connect, and see that there are workers that can fly."""
    from distributed import Client

    # What it would log, of connections that end, is told in our own words.
    for logger in ("distributed", "distributed.client"):
        logging.getLogger(logger).setLevel(logging.CRITICAL)
    if not asyncio.run(_is_scheduler(address)):
        raise InputError(
            f"--cluster {address}: no Dask scheduler answers there; start one with 'dask scheduler' or correct the "
            "address, as in tcp://HOST:8786."
        )
    client = Client(address, timeout=CONNECT_S, set_as_default=False)
    if why := _unfit(client):
        client.close()
        raise InputError(f"--cluster {address}: {why}")
    return client


async def _is_scheduler(address: str) -> bool:
    """Ask who is there; a client would wait for ever where something else than a scheduler listens."""
    from distributed import rpc

    try:
        async with asyncio.timeout(CONNECT_S), rpc(address) as there:
            told = cast("dict[str, object]", await there.identity())
            return told["type"] == "Scheduler"
    except Exception:  # noqa: BLE001 - anything may listen there, and answer anything
        return False


def _unfit(client: Client) -> str:
    """Return why the workers cannot fly, or ""."""
    if not client.nthreads():
        return "the scheduler has no workers; start some with 'dask worker ADDRESS --nworkers auto --nthreads 1'."
    told = cast("dict[str, object]", client.run(_version, on_error="return"))
    for worker, version in told.items():
        if version != __version__:
            there = version if isinstance(version, str) else f"none that can be imported ({version})"
            return f"the worker {worker} has groundstation {there}; install version {__version__} there."
    return ""


def _version() -> str:
    return __version__


def _send_controllers(client: Client, tasks: Sequence[Task]) -> None:
    """Send the workers the files that the users' own controllers are in."""
    for spec in {task.case.controller for task in tasks} - {*PRESET_NAMES}:
        found = importlib.util.find_spec(spec.partition(":")[0])
        if found is not None and found.origin is not None and found.parent == "":
            client.upload_file(found.origin)


def _submit(client: Client, task: Task) -> object:
    return client.submit(fly, task, key=f"flight-{task.id}", pure=False)
