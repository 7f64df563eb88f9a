"""The flights of a mission within one run, each measured for itself: landed and up again is another attempt."""

from __future__ import annotations

from collections import deque

from groundstation.training.director import Stage
from groundstation.training.happening import Happening
from groundstation.training.in_force import InForce
from groundstation.training.measurer import HandSight, Measurer, VehicleSight
from groundstation.training.mission import Mission


class Attempts:
    """Measures a run's flights as they are flown.

    Args:
        mission: What is flown.
        radius: The vehicle's, m.

    Attributes:
        current: Measures the flight under way, or the last one.
        landed: Those that ended and were not taken yet, in their order.
    """

    def __init__(self, mission: Mission, radius: float) -> None:
        self._mission, self._radius = mission, radius
        self.current = Measurer(mission, radius)
        self.landed: list[Measurer] = []
        self._last: Measurer | None = None
        self._instructed: deque[tuple[float, Happening]] = deque()
        self._in_force = InForce()

    @property
    def judged(self) -> Measurer:
        """The one that a run is judged by: the last that landed, else the one under way."""
        return self._last or self.current

    def take(self) -> list[Measurer]:
        """Return those that ended since, and keep them no longer: an afternoon may have a hundred."""
        taken, self.landed = self.landed, []
        return taken

    def instruct(self, t: float, happening: Happening) -> None:
        """Take note of what an instructor let happen at `t`, s; such notes come in the order of their times."""
        self._instructed.append((t, happening))

    def show(self, sight: VehicleSight | HandSight) -> bool:
        """Take note of a sight, and say whether it ended a flight; they come in the order of their times."""
        if isinstance(sight, HandSight):
            self.current.hand(sight)
            return False
        if self.current.director.stage is Stage.DONE and sight.armed and sight.in_air:
            coupled = self.current.coupled
            self.current = Measurer(self._mission, self._radius, coupled=coupled)
        while self._instructed and self._instructed[0][0] <= sight.t:
            t, happening = self._instructed.popleft()
            self._in_force.take(happening, t)
            self.current.instructed |= self.current.flying
        before = self.current.director.stage
        self.current.vehicle(sight)
        if self.current.flying and before is Stage.WAITING:
            # What was done on the ground counts as far as it lasts.
            self.current.instructed = bool(self._in_force.at(sight.t))
        ended = self.current.director.stage is Stage.DONE and before is not Stage.DONE
        if ended:
            self.landed.append(self.current)
            self._last = self.current
        return ended
