"""Where points were lost: the story of a flight that has landed, in words, as a lane of states and in the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import rerun as rr

from groundstation.messages import POINTS_LOST, PointsLost
from groundstation.recording import entities, lanes
from groundstation.recording.batch import Batch, text
from groundstation.recording.item import Chunk, time_column

# How long the lane shows a moment at least, s: long enough to be seen.
SHOWN_S = 0.5


class Story:
    """Turns a story into rows at the times of its moments.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
    """

    def __init__(self, start: float) -> None:
        self._start = start
        self._begun = False

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's moments."""
        losses = sorted(batch.of(POINTS_LOST), key=lambda loss: loss.t)
        if not losses:
            return
        times = time_column(np.array([loss.t for loss in losses]), self._start)
        words = [f"−{loss.points:.1f} {text(loss.part)}: {text(loss.text)}" for loss in losses]
        yield Chunk(entities.SCORE, times, rr.TextLog.columns(text=words, level=["WARN"] * len(losses)))
        places = [tuple(loss.position) for loss in losses]
        yield Chunk(entities.LOSSES, times, rr.Points3D.columns(positions=places, labels=words))
        changes = list(_changes(losses))
        if not self._begun:
            self._begun = True
            changes.insert(0, (self._start, lanes.QUIET))
        states = rr.StateChange.columns(state=[word for _, word in changes])
        yield Chunk(lanes.POINTS.path, time_column(np.array([t for t, _ in changes]), self._start), states)


def _changes(losses: Sequence[PointsLost]) -> Iterator[tuple[float, str]]:
    """Yield the lane's changes: of moments at the same time the costliest, and quiet where there is none."""
    edges = sorted({edge for loss in losses for edge in (loss.t, _end(loss))})
    before = ""
    for edge in edges:
        here = [loss for loss in losses if loss.t <= edge < _end(loss)]
        word = text(max(here, key=lambda loss: loss.points).part) if here else lanes.QUIET
        if word != before:
            yield edge, word
        before = word


def _end(loss: PointsLost) -> float:
    return max(loss.until, loss.t + SHOWN_S)
