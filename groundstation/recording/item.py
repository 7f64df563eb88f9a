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


def time_column(seconds: Numbers) -> rr.TimeColumn:
    """Return the times of rows, s since the run was started."""
    return rr.TimeColumn(TIMELINE, duration=np.rint(seconds * 1e9).astype("timedelta64[ns]"))


def send(stream: rr.RecordingStream, items: Iterable[Item]) -> None:
    """Send items to a stream; they are handed to its own thread and this returns at once."""
    for item in items:
        if isinstance(item, Chunk):
            stream.send_columns(item.path, [item.times], item.columns)
        else:
            stream.log(item.path, item.content, static=True)
