"""What is measured beside what it must not exceed, for plots: force and limit, clearance and margin."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import rerun as rr

from groundstation.config import Shield
from groundstation.messages import DEVICE_REPORT, HANDLE, MISSION_PROGRESS
from groundstation.recording import schema
from groundstation.recording.batch import Batch
from groundstation.recording.columns import rows_in
from groundstation.recording.item import Chunk, Numbers, time_column

# Ticks of the servo in a row: what it pushed at most within them.
_TICKS = 20


class Gauges:
    """Draws the lines beside which the numbers of a flight are read.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
        shield: Whose margin is drawn.
    """

    def __init__(self, start: float, shield: Shield) -> None:
        self._start = start
        self._margin = np.nan if shield.guard == "off" else shield.margin
        self._limit = np.nan

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's rows."""
        for report in batch.of(DEVICE_REPORT):
            self._limit = report.force_limit if report.present else np.nan
        if batch.of(HANDLE):
            rows = rows_in(batch, HANDLE)
            firsts = np.arange(0, len(rows), _TICKS)
            sizes = np.maximum.reduceat(np.linalg.norm(rows["force"], axis=1), firsts)
            yield self._chunk(schema.FORCE_SIZE, rows["t"][firsts], sizes, self._limit)
        if batch.of(MISSION_PROGRESS):
            rows = rows_in(batch, MISSION_PROGRESS)
            clearance = np.where(np.isfinite(rows["clearance"]), rows["clearance"], np.nan)
            # Where nothing stands there is nothing to keep a margin to.
            margin = np.where(np.isfinite(clearance), self._margin, np.nan)
            yield self._chunk(schema.MARGIN, rows["t"], margin)

    def _chunk(self, quantity: schema.Quantity, t: Numbers, *parts: Numbers | float) -> Chunk:
        columns = np.column_stack([np.broadcast_to(part, len(t)) for part in parts])
        return Chunk(quantity.path, time_column(t, self._start), rr.Scalars.columns(scalars=columns))
