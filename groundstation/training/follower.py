"""Follows a mission live: all that the bus tells of it is measured, and how it is going is told to the bus."""

from __future__ import annotations

from collections.abc import Iterable

from groundstation.bus import Bus
from groundstation.console import Snapshot
from groundstation.messages import (
    EVENT_TEXT,
    HANDLE,
    INTERVENTION_ANSWER,
    MISSION_PROGRESS,
    PART_TEXT,
    PILOT_STATE,
    POINTS_LOST,
    SCORE_TEXT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    PointsLost,
    Severity,
    fit,
)
from groundstation.training.attempts import Attempts
from groundstation.training.conducting import Conductor
from groundstation.training.director import Director
from groundstation.training.happening import INSTRUCTOR, unpacked
from groundstation.training.judgement import Judgement, judgement_of
from groundstation.training.measurer import HandSight, Measurer, VehicleSight
from groundstation.training.measures import Measures
from groundstation.training.mission import Mission
from groundstation.training.score import Score, score_of
from groundstation.training.sights import Sights
from groundstation.training.story import Moment
from groundstation.training.telling import so_far
from sim.airframe import load_airframe

_SCORE_EVERY_S = 1.0
_HELD_UP = (
    "Held up for seconds, handle samples were missed: 'groundstation review --score' has the exact score."
)


class MissionFollower:
    """Measures a mission in any flight, by hand or headless, from every record and not only from the newest.

    Args:
        mission: What is flown.
        bus: Where the records come from and the progress goes.
        par: What the flight is held against; None where nobody has flown it for reference.

    Attributes:
        attempts: The run's flights.
        score: Of the flight under way as far as it has come; None before, and where it is not judged.
        judgement: Of the last that landed; None before.
        complete: No record of a flight was missed.
    """

    def __init__(self, mission: Mission, bus: Bus, par: Measures | None = None) -> None:
        self.attempts = Attempts(mission, load_airframe(mission.vehicle.airframe).radius)
        self.judgement: Judgement | None = None
        self.complete = True
        self._bus, self._par = bus, par
        self._sights = Sights()
        self.score: Score | None = None
        self._words, self._next_score = b"", 0.0
        self._states = bus.subscriber(VEHICLE_STATE)
        self._statuses = bus.subscriber(VEHICLE_STATUS)
        self._pilots = bus.subscriber(PILOT_STATE)
        self._handles = bus.subscriber(HANDLE)
        self._interventions = bus.subscriber(INTERVENTION_ANSWER)
        self._conductor = Conductor(mission, bus)
        self._progress = bus.publisher(MISSION_PROGRESS)
        self._losses = bus.publisher(POINTS_LOST)

    @property
    def measurer(self) -> Measurer:
        """Measures the flight under way, or the last one."""
        return self.attempts.current

    @property
    def director(self) -> Director:
        """Knows how the flight under way is going."""
        return self.attempts.current.director

    def look(self, view: Snapshot) -> None:
        """Take note of what is new, and tell the bus how it is going."""
        self._read()
        self._conductor.look(self.director, view.t)
        self._judge(view.t)
        progress = self.director.progress(view.t)
        progress.score = self._words
        self._progress.send(progress)

    def finish(self) -> None:
        """Take note of what is left, when no more records come."""
        self._read()
        self._show(self._sights.rest())

    def _judge(self, t: float) -> None:
        """Work out the score so far, and its words for an instructor; it takes some milliseconds: not every time."""
        director = self.director
        if t < self._next_score or not director.mission.judged:
            return
        self._next_score = t + _SCORE_EVERY_S
        self.score = score_of(director.mission, self.measurer.measures(), self._par)
        self._words = fit(so_far(self.score), SCORE_TEXT) if self.score and director.elapsed(t) > 0.0 else b""

    def _read(self) -> None:
        for done in sorted(self._interventions.drain(), key=lambda answer: answer.t):
            happening = unpacked(done.happening)
            if done.ok and done.source == INSTRUCTOR and happening is not None:
                self.attempts.instruct(done.t, happening)
        # The order matters: see `Sights`.
        states = list(self._states.drain())
        statuses = list(self._statuses.drain())
        pilots = list(self._pilots.drain())
        handles = list(self._handles.drain())
        if self.complete and self.measurer.flying and len(handles) >= HANDLE.depth:
            self.complete = False
            self._bus.event(Severity.WARNING, _HELD_UP)
        self._show(self._sights.take(states, statuses, pilots, handles))

    def _show(self, sights: Iterable[VehicleSight | HandSight]) -> None:
        ended = False
        for sight in sights:
            ended |= self.attempts.show(sight)
        if ended:
            self.judgement = judgement_of(self.attempts.judged, self._par)
            self._tell(self.judgement.story)

    def _tell(self, story: Iterable[Moment]) -> None:
        """Tell the bus, and so the recording, where points were lost."""
        for moment in story:
            loss = PointsLost(t=moment.t, until=moment.until, points=moment.lost, position=moment.place)
            loss.part, loss.text = fit(moment.part, PART_TEXT), fit(moment.words, EVENT_TEXT)
            self._losses.send(loss)
