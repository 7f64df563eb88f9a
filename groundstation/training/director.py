"""How a mission is going: its stage, the way still to go, contacts with obstacles, and the verdict at the end.

Pure: fed with the vehicle's states as they come, live or from a recording.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

import msgspec

from groundstation.frames import Vector3, Vector4
from groundstation.messages import MissionProgress, fit
from groundstation.training.mission import Mission, Waypoint
from sim.environment.collision import RELEASE
from sim.environment.shapes import flown_through
from sim.environment.world import World
from sim.scenario import Gate

STAGE_TEXT = 48
# What is nearer than the vehicle's radius and this much is touched, m.
_CONTACT_MARGIN_M = 0.02
# Off the yaw that is asked for by less than this the vehicle points there, rad.
YAW_WITHIN = math.radians(15.0)


class Stage(Enum):
    """Where in the mission the vehicle is."""

    WAITING = "on the ground"
    TAKING_OFF = "taking off"
    ROUTE = "on the way"
    STAYING = "holding at the point"
    HOLDING = "holding at the target"
    RETURNING = "target held: land"
    LANDING = "to the pad: land there"
    FREE = "flying free"
    DONE = "landed"


class Goal(NamedTuple):
    """What is to be reached next.

    Attributes:
        at: World, m.
        radius: Near enough, m.
        yaw: Where the nose must point, rad; NaN for anywhere.
        say: What the trainee is told, or "".
    """

    at: Vector3
    radius: float
    yaw: float = math.nan
    say: str = ""


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
        landing_error: From the middle of the pad to where it landed, in the plane, m; NaN before, and without a pad.
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
    landing_error: float = math.nan

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
    _waypoints: tuple[Waypoint, ...] = ()
    _held_since: float | None = None
    _touching: str = ""
    _gates: list[Gate] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._waypoints = self.mission.waypoints
        self._gates = [obstacle for obstacle in self.mission.obstacle if isinstance(obstacle, Gate)]
        self.figures.gates = self.figures.gates_missed = len(self._gates)

    @property
    def legs(self) -> int:
        """Number of points to fly to: those of the route and the target."""
        return len(self._waypoints) + (1 if self.mission.target else 0)

    @property
    def goal(self) -> Goal | None:
        """What is to be reached next: a point of the route, the target, the pad; None where nothing is."""
        if self.leg < len(self._waypoints):
            at, radius, _, yaw_deg, say = msgspec.structs.astuple(self._waypoints[self.leg])
            return Goal(at, radius, _yaw(yaw_deg), say)
        target, pad = self.mission.target, self.mission.landing_pad
        if target and self.leg < self.legs:
            return Goal(target.position, target.radius, _yaw(target.yaw_deg))
        return Goal(pad.position, pad.radius) if pad and self.stage is not Stage.DONE else None

    def vehicle(self, t: float, position: Vector4, *, in_air: bool, armed: bool) -> None:
        """Take note of where the vehicle is at `t` (s): x, y, z, yaw; world, m and rad."""
        x, y, z, yaw = position
        place = (x, y, z)
        if self.stage is Stage.WAITING:
            if not (armed and in_air):
                return
            self.stage, self._took_off_t = Stage.TAKING_OFF, t
        if self.stage is Stage.DONE:
            return
        self.figures.duration = t - self._took_off_t
        if self._last is not None:
            self.figures.path += math.dist(self._last, place)
            self._gates = [gate for gate in self._gates if not flown_through(gate, self._last, place)]
            self.figures.gates_missed = len(self._gates)
        self._last = place
        self._watch_obstacles(place)
        if not armed:
            self._land(place)
        elif self.stage is Stage.TAKING_OFF:
            if z > self.mission.takeoff_altitude_m - 0.3:
                self.stage = Stage.ROUTE
        else:
            self._follow(t, place, yaw)

    def controller(self, error: Vector3, force: Vector3) -> None:
        """Take note of the position error (m) and the force on the hand (N) while engaged."""
        self.figures.error_squares += error[0] ** 2 + error[1] ** 2 + error[2] ** 2
        self.figures.error_count += 1
        self.figures.max_force = max(self.figures.max_force, math.hypot(*force))

    @property
    def at_the_end(self) -> bool:
        """Whether nothing is left but to land: the target was held, or there is none behind the route."""
        return self.stage in {Stage.RETURNING, Stage.LANDING, Stage.FREE}

    @property
    def stay(self) -> tuple[float, float]:
        """How long the goal is to be stayed at, and how long it has been so far, s."""
        asked = 0.0
        if self.leg < len(self._waypoints):
            asked = self._waypoints[self.leg].hold_s
        elif self.mission.target and self.leg < self.legs:
            asked = self.mission.target.hold_s
        since = self._held_since
        return asked, 0.0 if since is None else self._took_off_t + self.figures.duration - since

    @property
    def missed(self) -> tuple[Gate, ...]:
        """The gates not flown through yet."""
        return tuple(self._gates)

    def elapsed(self, t: float) -> float:
        """Return the time since take-off, s; 0 before it."""
        return 0.0 if self.stage is Stage.WAITING else t - self._took_off_t

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
        if self.leg < len(self._waypoints):
            found.append(f"{self.leg} of {len(self._waypoints)} points were reached")
        found += self._landing_shortcomings()
        found += [f"gate {gate.name!r} was not flown through" for gate in self._gates]
        if figures.collisions > criteria.max_collisions:
            found.append(f"{figures.collisions} collisions, {criteria.max_collisions} forgiven")
        if figures.least_clearance < criteria.min_clearance_m:
            found.append(
                f"clearance {figures.least_clearance:.2f} m is under {criteria.min_clearance_m:.2f} m"
            )
        if figures.duration > criteria.time_limit_s:
            found.append(f"{figures.duration:.0f} s is over {criteria.time_limit_s:.0f} s")
        return found

    def _landing_shortcomings(self) -> list[str]:
        pad, error = self.mission.landing_pad, self.figures.landing_error
        if pad is None or self.stage is not Stage.DONE or error <= pad.radius:
            return []
        return [
            f"it landed {error:.2f} m from the middle of pad {pad.name!r}, whose radius is {pad.radius:g} m"
        ]

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

    def _land(self, position: Vector3) -> None:
        self.stage = Stage.DONE
        if pad := self.mission.landing_pad:
            self.figures.landing_error = math.dist(pad.position[:2], position[:2])

    def _follow(self, t: float, position: Vector3, yaw: float) -> None:
        """Advance along the route, then hold at the target, then land."""
        if self.at_the_end:
            return
        target = self.mission.target
        if self.leg < len(self._waypoints):
            waypoint = self._waypoints[self.leg]
            if self._stays(t, position, yaw, waypoint.hold_s):
                self.leg += 1
                self._held_since = None
                self.stage = Stage.ROUTE
            elif self._held_since is not None:
                self.stage = Stage.STAYING
            else:
                self.stage = Stage.ROUTE
            if self.leg < len(self._waypoints) or target:
                return
        if target is None:
            self.stage = Stage.LANDING if self.mission.landing else Stage.FREE
        elif self._stays(t, position, yaw, target.hold_s):
            self.figures.final_error = math.dist(target.position, position)
            self.leg = self.legs
            self.stage = Stage.LANDING if self.mission.landing else Stage.RETURNING
        else:
            self.stage = Stage.HOLDING if self._held_since is not None else Stage.ROUTE

    def _stays(self, t: float, position: Vector3, yaw: float, hold_s: float) -> bool:
        """Say whether the vehicle has been at the goal, nose where it belongs, for so long."""
        goal = self.goal
        assert goal is not None
        there = math.dist(goal.at, position) <= goal.radius
        # Anywhere is NaN, and no comparison with it holds.
        if not there or abs(math.remainder(yaw - goal.yaw, math.tau)) > YAW_WITHIN:
            self._held_since = None
            return False
        if self._held_since is None:
            self._held_since = t
        return t - self._held_since >= hold_s


def _yaw(yaw_deg: float | None) -> float:
    return math.nan if yaw_deg is None else math.radians(yaw_deg)
