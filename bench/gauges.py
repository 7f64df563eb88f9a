"""What a running process has taken of the system: memory, descriptors, threads, as Linux counts them."""

from __future__ import annotations

import statistics
from pathlib import Path
from typing import NamedTuple


class Reading(NamedTuple):
    """A process at one moment.

    Attributes:
        t: When, monotonic s.
        memory: Its own memory, MB: anonymous pages, without files and what it shares with others.
        descriptors, threads: How many are open, and run.
    """

    t: float
    memory: float
    descriptors: int
    threads: int


def read(pid: int, t: float) -> Reading | None:
    """Return a reading, or None where the process has gone."""
    folder = Path(f"/proc/{pid}")
    try:
        words = dict(
            line.split(":", 1) for line in (folder / "status").read_text().splitlines() if ":" in line
        )
        descriptors = sum(1 for _ in (folder / "fd").iterdir())
    except OSError:
        return None
    if "RssAnon" not in words:
        return None
    return Reading(t, int(words["RssAnon"].split()[0]) / 1024.0, descriptors, int(words["Threads"]))


class Growth(NamedTuple):
    """What has changed between two stretches of readings, in their medians: peaks of a moment are no growth."""

    before: Reading
    after: Reading

    @property
    def memory(self) -> float:
        """MB."""
        return self.after.memory - self.before.memory

    @property
    def descriptors(self) -> int:
        """Descriptors."""
        return self.after.descriptors - self.before.descriptors

    def __str__(self) -> str:
        one, other = self
        return (
            f"{one.memory:7.1f} → {other.memory:6.1f} MB ({self.memory:+5.2f})  descriptors {one.descriptors:3} → "
            f"{other.descriptors:3}  threads {one.threads:2} → {other.threads:2}"
        )


def growth(readings: list[Reading], share: float = 0.1) -> Growth:
    """Return how the last readings differ from the first, each a share of all."""
    count = max(1, round(share * len(readings)))
    return Growth(_middle(readings[:count]), _middle(readings[-count:]))


def _middle(readings: list[Reading]) -> Reading:
    return Reading(
        readings[0].t,
        statistics.median(each.memory for each in readings),
        round(statistics.median(each.descriptors for each in readings)),
        round(statistics.median(each.threads for each in readings)),
    )
