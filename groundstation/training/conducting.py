"""Carries out a mission's timetable in a live flight: asks for each event when it is due."""

from __future__ import annotations

from groundstation.bus import Bus
from groundstation.messages import Severity
from groundstation.training.asking import Asker
from groundstation.training.director import Director, Stage
from groundstation.training.events import Timetable
from groundstation.training.happening import Calm, unpacked, words
from groundstation.training.mission import Mission

_NOT_FLYING = frozenset({Stage.WAITING, Stage.DONE})


class Conductor:
    """Follows the flight's director.

    Args:
        mission: Has the timetable.
        bus: The flight's.
    """

    def __init__(self, mission: Mission, bus: Bus) -> None:
        self._events = mission.event
        self._bus = bus
        self._asker = Asker(bus, "mission") if mission.event else None
        self._director: Director | None = None
        self._timetable = Timetable(mission.event)

    def look(self, director: Director, t: float) -> None:
        """Ask for what is due at `t`, s; another director is another flight, which begins as the first did."""
        if self._asker is None:
            return
        if director is not self._director:
            if self._director is not None:
                self._asker.ask(Calm())
                self._timetable = Timetable(self._events)
            self._director = director
        if director.stage not in _NOT_FLYING:
            for event in self._timetable.due(director.elapsed(t), director.leg):
                self._asker.ask(event)
        for answer in self._asker.answers():
            happening = unpacked(answer.happening)
            if not answer.ok and happening is not None:
                why = answer.text.decode(errors="replace")
                self._bus.event(
                    Severity.WARNING, f"The mission's timetable is not kept: {words(happening)}: {why}."
                )
