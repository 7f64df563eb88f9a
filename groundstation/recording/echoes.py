"""What the vehicle's own distance sensors see, as points in the scene."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import rerun as rr

from groundstation.messages import OBSTACLES, RING_SECTORS, VEHICLE_STATE
from groundstation.recording import entities
from groundstation.recording.batch import Batch
from groundstation.recording.columns import Rows, rows_of
from groundstation.recording.item import Chunk, Numbers, time_column

_ANGLES = np.arange(RING_SECTORS) * (2.0 * np.pi / RING_SECTORS)


class Echoes:
    """Places what is measured, from where the vehicle was then.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
    """

    def __init__(self, start: float) -> None:
        self._start = start
        self._times = np.full(1, -np.inf)
        self._poses = np.full((1, 4), np.nan)

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's points; none before the vehicle has told where it is."""
        if states := [state for state in batch.of(VEHICLE_STATE) if state.valid]:
            rows = rows_of(states)
            self._times = np.concatenate((self._times[-1:], rows["t"]))
            self._poses = np.concatenate((self._poses[-1:], rows["position"]))
        if not (records := batch.of(OBSTACLES)):
            return
        rows = rows_of(records)
        newest = np.searchsorted(self._times, rows["t"], side="right") - 1
        points = _placed(rows, self._poses[np.maximum(newest, 0)])
        there = np.isfinite(points).all(axis=2)
        lengths = there.sum(axis=1).astype(np.int32)
        columns = rr.Points3D.columns(positions=points[there]).partition(lengths)
        yield Chunk(entities.ECHOES, time_column(rows["t"], self._start), columns)


def _placed(rows: Rows, poses: Numbers) -> Numbers:
    """Return the ring's points and those below and above, (n, RING_SECTORS + 2, 3), world, m; not finite: none."""
    angles = poses[:, 3:] + _ANGLES
    ways = np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), axis=2)
    ring = np.where(np.isfinite(rows["ring"]), rows["ring"], np.nan)
    around = ways * ring[:, :, None]
    upright = np.zeros((len(rows), 2, 3))
    upright[:, :, 2] = np.column_stack((-rows["below"], rows["above"]))
    return poses[:, None, :3] + np.concatenate((around, upright), axis=1)
