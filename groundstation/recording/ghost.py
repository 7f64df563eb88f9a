"""The ghost of an earlier flight in the scene, moving beside the vehicle at the same time since take-off."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import rerun as rr

from groundstation.messages import VEHICLE_STATUS
from groundstation.recording import entities
from groundstation.recording.batch import Batch
from groundstation.recording.item import Chunk, time_column
from groundstation.training.ghost import ghost_at, ghost_trail
from groundstation.training.measures import Track

_TRAIL_S = 8.0
# So often its place is written, s: between the rows of its track it moves straight.
_EVERY_S = 0.1


class Ghost:
    """Writes where the ghost is, as far as the flight has come.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
        track: Of the earlier flight; None: there is none.
    """

    def __init__(self, start: float, track: Track | None) -> None:
        self._start, self._track = start, track
        self._took_off = self._next = math.nan

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield where it was in a batch's time; with the landing it goes."""
        statuses = batch.of(VEHICLE_STATUS) if self._track is not None else []
        for status in statuses:
            flying = bool(status.armed and status.in_air)
            if flying and math.isnan(self._took_off):
                self._took_off = self._next = status.t
            elif not status.armed and not math.isnan(self._took_off):
                yield from self._placed(status.t)
                yield from self._rows([status.t], gone=True)
                self._took_off = math.nan
        if statuses and not math.isnan(self._took_off):
            yield from self._placed(statuses[-1].t)

    def _placed(self, until: float) -> Iterator[Chunk]:
        """Yield the places up to a time, monotonic s."""
        times: list[float] = []
        while self._next <= until:
            times.append(self._next)
            self._next += _EVERY_S
        if times:
            yield from self._rows(times)

    def _rows(self, times: list[float], *, gone: bool = False) -> Iterator[Chunk]:
        """Yield a row a time; empty where the ghost has gone or is not there yet."""
        assert self._track is not None
        elapsed = [0.0 if gone else t - self._took_off for t in times]
        places = [ghost_at(self._track, each) for each in elapsed]
        trails = [ghost_trail(self._track, each, _TRAIL_S) for each in elapsed]
        lengths = np.array([place is not None for place in places], np.int32)
        column = time_column(np.array(times), self._start)
        points = np.array([place for place in places if place], np.float32).reshape(-1, 3)
        yield Chunk(entities.GHOST, column, rr.Points3D.columns(positions=points).partition(lengths))
        strips = [trail for trail in trails if trail]
        lines = rr.LineStrips3D.columns(strips=strips).partition(lengths)
        yield Chunk(entities.GHOST_TRAIL, column, lines)
