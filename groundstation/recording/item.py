"""What is sent to a Rerun stream: rows of an entity over time, or what holds for the whole flight."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import rerun as rr

from groundstation.recording.schema import TIMELINE

Numbers = npt.NDArray[np.float64]


class Chunk(NamedTuple):
    """Rows of one entity, ready to be sent to any number of streams."""

    path: str
    times: rr.TimeColumn
    columns: Iterable[rr.ComponentColumn]


class Still(NamedTuple):
    """What has no time; logged again it replaces what was logged before."""

    path: str
    content: rr.AsComponents


Item = Chunk | Still


def nanoseconds(seconds: Numbers) -> npt.NDArray[np.int64]:
    """Return times as whole nanoseconds: divided by 1e9 those of a clock are the very same floats again.

    A clock counts nanoseconds n and tells n / 1e9. After seven weeks of uptime the product back may be rounded to the
    one beside it.

    Args:
        seconds: (n,), of a clock.
    """
    found = np.rint(seconds * 1e9).astype(np.int64)
    for beside in (1, -1):
        tried = found + beside
        found = np.where((found / 1e9 != seconds) & (tried / 1e9 == seconds), tried, found)
    return found


def time_column(seconds: Numbers, start: float = 0.0) -> rr.TimeColumn:
    """Return the times of rows since the run was started, to the nanosecond.

    Args:
        seconds: (n,), s on the clock that `start` is of.
        start: What is 0 on the timeline.
    """
    since = nanoseconds(seconds) - nanoseconds(np.array([start]))
    return rr.TimeColumn(TIMELINE, duration=since.astype("timedelta64[ns]"))


def send(stream: rr.RecordingStream, items: Iterable[Item]) -> None:
    """Send items to a stream; they are handed to its own thread and this returns at once."""
    for item in items:
        if isinstance(item, Chunk):
            stream.send_columns(item.path, [item.times], item.columns)
        else:
            stream.log(item.path, item.content, static=True)
