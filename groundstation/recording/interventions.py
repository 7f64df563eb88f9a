"""What an instructor or a timetable let happen: a lane of what is in force, in words, and as it was asked for."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import numpy as np
import rerun as rr

from groundstation.messages import INTERVENTION, INTERVENTION_ANSWER, VEHICLE_STATUS, InterventionAnswer
from groundstation.recording import entities, lanes
from groundstation.recording.batch import Batch, text
from groundstation.recording.item import Chunk, time_column
from groundstation.training.happening import unpacked, words
from groundstation.training.in_force import NOTHING, InForce

_INFO, _WARNING = "INFO", "WARN"


class Interventions:
    """Turns requests and answers into rows.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
    """

    def __init__(self, start: float) -> None:
        self._start = start
        self._in_force = InForce()
        self._state = ""

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's rows; none in a flight that is left alone."""
        answers = sorted(batch.of(INTERVENTION_ANSWER), key=lambda answer: answer.t)
        if changed := list(self._changes(batch, answers)):
            times, states = zip(*changed, strict=True)
            columns = rr.StateChange.columns(state=list(states))
            yield Chunk(lanes.INTERVENTION.path, self._times(times), columns)
        for answer in answers:
            path = f"{entities.EVENTS}/{text(answer.source)}"
            yield self._line(path, answer.t, _told(answer), _INFO if answer.ok else _WARNING)
        for asked in batch.of(INTERVENTION):
            words = f"asked {asked.number} {text(asked.source)} {text(asked.happening)}"
            yield self._line(entities.INTERVENTIONS, asked.t, words, _INFO)
        for answer in answers:
            kind = "done" if answer.ok else "refused"
            words = f"{kind} {answer.number} {text(answer.source)} {text(answer.happening)}"
            why = f" {text(answer.text)}" if answer.text else ""
            yield self._line(entities.INTERVENTIONS, answer.t, f"{words}{why}", _INFO)

    def _changes(self, batch: Batch, answers: list[InterventionAnswer]) -> Iterator[tuple[float, str]]:
        """Yield when what is in force changes; what ends by itself has ended by the next status."""
        done = deque(
            (answer.t, happening)
            for answer in answers
            if answer.ok and (happening := unpacked(answer.happening)) is not None
        )
        times = {*(t for t, _ in done), *(status.t for status in batch.of(VEHICLE_STATUS))}
        for t in sorted(times):
            while done and done[0][0] <= t:
                began, happening = done.popleft()
                self._in_force.take(happening, began)
                self._state = self._state or NOTHING
            if self._state and (state := self._in_force.state(t)) != self._state:
                self._state = state
                yield t, state

    def _line(self, path: str, t: float, words: str, level: str) -> Chunk:
        return Chunk(path, self._times((t,)), rr.TextLog.columns(text=[words], level=[level]))

    def _times(self, times: tuple[float, ...]) -> rr.TimeColumn:
        return time_column(np.array(times), self._start)


def _told(answer: InterventionAnswer) -> str:
    happening = unpacked(answer.happening)
    told = words(happening) if happening is not None else text(answer.happening)
    told = f"{told[:1].upper()}{told[1:]}"
    return f"{told}." if answer.ok else f"{told} refused: {text(answer.text)}."
