"""Follows a mission live: all that the bus tells of it is measured, and how it is going is told to the bus."""

from __future__ import annotations

from groundstation.bus import Bus
from groundstation.console import Snapshot
from groundstation.messages import HANDLE, MISSION_PROGRESS, PILOT_STATE, VEHICLE_STATE, VEHICLE_STATUS
from groundstation.training.attempts import Attempts
from groundstation.training.conducting import Conductor
from groundstation.training.director import Director
from groundstation.training.measurer import Measurer
from groundstation.training.mission import Mission
from groundstation.training.sights import Sights
from sim.airframe import load_airframe


class MissionFollower:
    """Measures a mission in any flight, by hand or headless, from every record and not only from the newest.

    Args:
        mission: What is flown.
        bus: Where the records come from and the progress goes.

    Attributes:
        attempts: The run's flights.
        complete: No record was missed: held up for seconds, what it says may differ from what the recording says.
    """

    def __init__(self, mission: Mission, bus: Bus) -> None:
        self.attempts = Attempts(mission, load_airframe(mission.vehicle.airframe).radius)
        self.complete = True
        self._sights = Sights()
        self._states = bus.subscriber(VEHICLE_STATE)
        self._statuses = bus.subscriber(VEHICLE_STATUS)
        self._pilots = bus.subscriber(PILOT_STATE)
        self._handles = bus.subscriber(HANDLE)
        self._conductor = Conductor(mission, bus)
        self._progress = bus.publisher(MISSION_PROGRESS)

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
        self._progress.send(self.director.progress(view.t))

    def finish(self) -> None:
        """Take note of what is left, when no more records come."""
        self._read()
        for sight in self._sights.rest():
            self.attempts.show(sight)

    def _read(self) -> None:
        # The order matters: see `Sights`.
        states = list(self._states.drain())
        statuses = list(self._statuses.drain())
        pilots = list(self._pilots.drain())
        handles = list(self._handles.drain())
        self.complete &= len(handles) < HANDLE.depth
        for sight in self._sights.take(states, statuses, pilots, handles):
            self.attempts.show(sight)
