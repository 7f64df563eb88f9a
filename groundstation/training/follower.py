"""Follows a mission live: what the console sees goes to the director, and how it is going onto the bus."""

from __future__ import annotations

from groundstation.bus import Bus
from groundstation.console import Snapshot
from groundstation.messages import MISSION_PROGRESS, Phase
from groundstation.training.conducting import Conductor
from groundstation.training.director import Director, Stage
from groundstation.training.mission import Mission
from sim.airframe import load_airframe
from sim.environment.world import World


class MissionFollower:
    """Feeds a director from snapshots, in any flight, by hand or headless.

    Args:
        mission: What is flown.
        bus: Where the progress goes.

    Attributes:
        director: Knows how the mission is going.
    """

    def __init__(self, mission: Mission, bus: Bus) -> None:
        radius = load_airframe(mission.vehicle.airframe).radius
        self._begin = lambda: Director(mission, World(mission.obstacle), radius)
        self.director = self._begin()
        self._conductor = Conductor(mission, bus)
        self._progress = bus.publisher(MISSION_PROGRESS)
        self._seen_t = 0.0
        self._controlled_t = 0.0

    def look(self, view: Snapshot) -> None:
        """Take note of what is new in a snapshot, and tell the bus."""
        status, state, pilot = view.status, view.vehicle, view.pilot
        if self.director.stage is Stage.DONE and status and status.armed and status.in_air:
            # Landed, and up again in the same run: that is another flight.
            self.director = self._begin()
        if status and state and state.valid and state.t > self._seen_t:
            self._seen_t = state.t
            x, y, z, yaw = state.position
            self.director.vehicle(
                state.t, (x, y, z, yaw), in_air=bool(status.in_air), armed=bool(status.armed)
            )
        if pilot and pilot.phase == Phase.ENGAGED and pilot.t > self._controlled_t:
            self._controlled_t = pilot.t
            force = tuple(view.handle.force) if view.handle else (0.0, 0.0, 0.0)
            self.director.controller((pilot.error[0], pilot.error[1], pilot.error[2]), force)
        self._conductor.look(self.director, view.t)
        self._progress.send(self.director.progress(view.t))
