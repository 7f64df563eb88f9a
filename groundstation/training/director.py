"""How a mission is going: its stage, the way still to go, contacts with obstacles, and the verdict at the end.

Pure: fed with the vehicle's states as they come, live or from a recording.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum

from groundstation.frames import Vector3
from groundstation.messages import MissionProgress, fit
from groundstation.training.mission import Mission
from sim.environment.collision import RELEASE
from sim.environment.shapes import flown_through
from sim.environment.world import World
from sim.scenario import Gate

STAGE_TEXT = 48
# What is nearer than the vehicle's radius and this much is touched, m.
_CONTACT_MARGIN_M = 0.02


class Stage(Enum):
    """Where in the mission the vehicle is."""

    WAITING = "on the ground"
    TAKING_OFF = "taking off"
    ROUTE = "on the way"
    HOLDING = "holding at the target"
    RETURNING = "target held: land"
    FREE = "flying free"
    DONE = "landed"


@dataclass(slots=True)
class Figures:
    """What a flight has come to so far.

    Attributes:
        path: Way flown, m.
        error_squares: Sum of |p̃|² over the samples while engaged, m²; `error_count` of them.
        final_error: Distance to the target at the end of the hold, m; NaN before.
        max_force: Largest force on the hand, N.
        duration: From take-off to landing, or to now, s.
        collisions: Contacts with obstacles.
        least_clearance: From the hull to the nearest obstacle, the least in the air so far, m; infinite without any.
        gates, gates_missed: Those of the mission, and those of them not flown through yet.
    """

    path: float = 0.0
    error_squares: float = 0.0
    error_count: int = 0
    final_error: float = math.nan
    max_force: float = 0.0
    duration: float = 0.0
    collisions: int = 0
    least_clearance: float = math.inf
    gates: int = 0
    gates_missed: int = 0

    @property
    def rms_error(self) -> float:
        """Root mean square of |p̃| on x, y, z while engaged, m."""
        return math.sqrt(self.error_squares / self.error_count) if self.error_count else math.nan


@dataclass(slots=True)
class Director:
    """Follows a mission.

    Args:
        mission: What is flown.
        world: Its obstacles.
        radius: The vehicle's, m: nearer to an obstacle than this is a contact.
    """

    mission: Mission
    world: World
    radius: float
    stage: Stage = Stage.WAITING
    leg: int = 0
    figures: Figures = field(default_factory=Figures)
    clearance: float = math.inf
    _last: Vector3 | None = None
    _took_off_t: float = 0.0
    _held_since: float | None = None
    _touching: str = ""
    _gates: list[Gate] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._gates = [obstacle for obstacle in self.mission.obstacle if isinstance(obstacle, Gate)]
        self.figures.gates = self.figures.gates_missed = len(self._gates)

    @property
    def legs(self) -> int:
        """Number of points to fly to: those of the route and the target."""
        return len(self.mission.route) + (1 if self.mission.target else 0)

    def vehicle(self, t: float, position: Vector3, *, in_air: bool, armed: bool) -> None:
        """Take note of the vehicle's position (world, m) at `t` (s)."""
        if self.stage is Stage.WAITING:
            if not (armed and in_air):
                return
            self.stage, self._took_off_t = Stage.TAKING_OFF, t
        if self.stage is Stage.DONE:
            return
        self.figures.duration = t - self._took_off_t
        if self._last is not None:
            self.figures.path += math.dist(self._last, position)
            self._gates = [gate for gate in self._gates if not flown_through(gate, self._last, position)]
            self.figures.gates_missed = len(self._gates)
        self._last = position
        self._watch_obstacles(position)
        if not armed:
            self.stage = Stage.DONE
        elif self.stage is Stage.TAKING_OFF:
            if position[2] > self.mission.takeoff_altitude_m - 0.3:
                self.stage = Stage.ROUTE
        else:
            self._follow(t, position)

    def controller(self, error: Vector3, force: Vector3) -> None:
        """Take note of the position error (m) and the force on the hand (N) while engaged."""
        self.figures.error_squares += error[0] ** 2 + error[1] ** 2 + error[2] ** 2
        self.figures.error_count += 1
        self.figures.max_force = max(self.figures.max_force, math.hypot(*force))

    @property
    def at_the_end(self) -> bool:
        """Whether nothing is left to fly to: the target was held, or there is none behind the route."""
        return self.stage in {Stage.RETURNING, Stage.FREE}

    def target_distance(self) -> float:
        """Return the distance to the target, m; NaN without one."""
        if self.mission.target is None or self._last is None:
            return math.nan
        return math.dist(self.mission.target.position, self._last)

    def shortcomings(self) -> list[str]:
        """Return in words each criterion that the finished flight does not meet."""
        criteria, figures = self.mission.criteria, self.figures
        found: list[str] = []
        if self.stage is not Stage.DONE:
            found.append(f"it did not end landed but {self.stage.value}")
        if self.mission.target and math.isnan(figures.final_error):
            found.append("the target was not reached and held")
        elif figures.final_error > criteria.final_error_m:
            found.append(f"final error {figures.final_error:.2f} m is over {criteria.final_error_m:.2f} m")
        found += [f"gate {gate.name!r} was not flown through" for gate in self._gates]
        if figures.collisions > criteria.max_collisions:
            found.append(f"{figures.collisions} collisions, {criteria.max_collisions} forgiven")
        if figures.duration > criteria.time_limit_s:
            found.append(f"{figures.duration:.0f} s is over {criteria.time_limit_s:.0f} s")
        return found

    def progress(self, t: float) -> MissionProgress:
        """Return the record for the bus."""
        record = MissionProgress(
            t=t,
            leg=self.leg,
            legs=self.legs,
            target_distance=self.target_distance(),
            clearance=self.clearance,
            collisions=self.figures.collisions,
        )
        record.stage = fit(self.stage.value, STAGE_TEXT)
        return record

    def _watch_obstacles(self, position: Vector3) -> None:
        distance, name = self.world.clearance(position)
        self.clearance = distance - self.radius
        self.figures.least_clearance = min(self.figures.least_clearance, self.clearance)
        within = RELEASE if name == self._touching else _CONTACT_MARGIN_M
        touching = name if self.clearance < within else ""
        if touching and touching != self._touching:
            self.figures.collisions += 1
        self._touching = touching

    def _follow(self, t: float, position: Vector3) -> None:
        """Advance along the route, then hold at the target."""
        target = self.mission.target
        if self.leg < len(self.mission.route):
            if math.dist(self.mission.route[self.leg], position) < 1.0:
                self.leg += 1
            return
        if target is None:
            self.stage = Stage.FREE
            return
        if self.stage is Stage.RETURNING:
            return
        if math.dist(target.position, position) > target.radius:
            self._held_since, self.stage = None, Stage.ROUTE
            return
        self.stage = Stage.HOLDING
        if self._held_since is None:
            self._held_since = t
        if t - self._held_since >= target.hold_s:
            self.figures.final_error = math.dist(target.position, position)
            self.leg = self.legs
            self.stage = Stage.RETURNING
