"""Which flights run on this machine, and which of them is meant."""

from __future__ import annotations

from pathlib import Path

import msgspec

from groundstation.errors import InputError
from groundstation.run import Run, read_run, run_file
from groundstation.run_folder import living_runs


def running_flights() -> list[Run]:
    """Return the flights that run and are ours to look at, the first started first."""
    found: list[Run] = []
    for run_id in living_runs():
        try:
            found.append(read_run(run_file(run_id)))
        except (OSError, msgspec.DecodeError):
            # It has just ended, is just beginning, or is another user's.
            continue
    return sorted(found, key=lambda run: run.started)


def chosen(flights: list[Run], name: str | None) -> Run:
    """Return the flight that is meant.

    Args:
        flights: Those that run.
        name: Its pilot, mission, run or process number; None where there should be only one.

    Raises:
        InputError: There is none, or more than one.
    """
    meant = [run for run in flights if name is None or name in _names(run)]
    if len(meant) == 1:
        return meant[0]
    if not flights:
        raise InputError("no flight runs on this machine; start one with 'groundstation --sim' first.")
    there = "; ".join(title(run) for run in flights)
    if not meant:
        raise InputError(f"--run {name}: no such flight; there are: {there}.")
    raise InputError(f"several flights run; choose one with --run: {there}.")


def title(run: Run) -> str:
    """Return a flight in a few words."""
    real = "" if run.simulated else ", a REAL vehicle"
    return f"{run.run_id} ({run.pilot or 'nobody by name'}, {_mission(run)}{real})"


def _names(run: Run) -> set[str]:
    return {run.run_id, run.run_id.partition("-")[0], run.pilot, _mission(run), Path(run.log).name} - {""}


def _mission(run: Run) -> str:
    return run.mission.name if run.mission else "free"
