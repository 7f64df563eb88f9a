"""Measures a flight as it is flown: live, from a recording, in virtual time. One implementation, so that they agree.

It is shown the vehicle and the hand in the order of their times, and nothing else: the same rows give the same
numbers, to the last bit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from groundstation.frames import Vector3, Vector4
from groundstation.training.director import Director, Stage
from groundstation.training.measures import Measures, Track
from groundstation.training.mission import Mission
from groundstation.training.rows import HandRow, Rows, VehicleRow
from groundstation.training.smoothness import Smoothness
from groundstation.training.track import TrackKeeper
from groundstation.training.way import off_the_way, way_of
from sim.environment.world import World

# Rows of one stretch of motion lie no further apart, s: telemetry comes far more often, even with losses.
_GAP_S = 1.0


class VehicleSight(NamedTuple):
    """The vehicle as it told of itself.

    Attributes:
        t: When, s on any clock; the same for all that is shown.
        position: x, y, z, yaw; world, m and rad.
        velocity: x, y, z; world, m/s.
        armed, in_air: As it said last before `t`.
    """

    t: float
    position: Vector4
    velocity: Vector3
    armed: bool
    in_air: bool


class HandSight(NamedTuple):
    """The hand and what the controller makes of it.

    Attributes:
        t: When, s on the same clock.
        coupled: The vehicle follows the hand.
        error: p̃ on x, y, z; world, m.
        disagreement: |v_ref − v_safe| without yaw, m/s: what the guard changes; NaN where it is not known.
        force: Rendered on the hand, N.
        on_leash: p_h is as far ahead as it may be.
    """

    t: float
    coupled: bool
    error: Vector3
    disagreement: float
    force: Vector3
    on_leash: bool = False


class Mean:
    """The mean of what was added; what is not finite is not known, and left out."""

    def __init__(self) -> None:
        self._sum, self._count = 0.0, 0

    def add(self, value: float) -> None:
        """Take a value in."""
        if math.isfinite(value):
            self._sum += value
            self._count += 1

    @property
    def value(self) -> float:
        """NaN before the first."""
        return self._sum / self._count if self._count else math.nan


class Measurer:
    """Measures one flight of a mission, from take-off to landing.

    Args:
        mission: What is flown.
        radius: The vehicle's, m.
        coupled: The vehicle follows the hand already.

    Attributes:
        director: Follows the mission.
        coupled: The vehicle follows the hand.
        vehicle_rows, hand_rows: What its story is told from, in the order of time; none where it is not judged.
        collisions: When obstacles were touched, s, and which.
        took_off_t, end_t: When it took off, and landed or was seen last, s; NaN before.
        held_t: When the target had been held for long enough, s; NaN before.
        place: Where it was seen last, world, m.
        instructed: An instructor let something happen: it was not flown under the mission's own conditions.
    """

    def __init__(self, mission: Mission, radius: float, *, coupled: bool = False) -> None:
        self._world = World(mission.obstacle)
        self._way = way_of(mission)
        self.coupled, self.instructed = coupled, False
        self.director = Director(mission, self._world, radius)
        self.vehicle_rows = Rows(VehicleRow.numbers, VehicleRow.of, 7)
        self.hand_rows = Rows(HandRow.numbers, HandRow.of, 5)
        self._track = TrackKeeper()
        self._smoothness = Smoothness(_GAP_S)
        self._off_squared, self._disagreement, self._effort = Mean(), Mean(), Mean()
        self.collisions: list[tuple[float, str]] = []
        self.took_off_t = self.end_t = self.held_t = math.nan
        self.place: Vector3 = (0.0, 0.0, 0.0)

    def vehicle(self, sight: VehicleSight) -> None:
        """Take note of the vehicle."""
        director, (x, y, z, _) = self.director, sight.position
        collisions = director.figures.collisions
        # The row belongs to the leg that was under way up to now: the point that ends it lies on both.
        off = self._off(leg=director.leg, place=(x, y, z))
        if director.stage is Stage.DONE:
            return
        director.vehicle(sight.t, sight.position, in_air=sight.in_air, armed=sight.armed)
        if director.stage is Stage.WAITING:
            return
        self._mark(sight.t, (x, y, z))
        if director.figures.collisions > collisions:
            self.collisions.append((sight.t, self.nearest((x, y, z))))
        if self.coupled and self.flying:
            speed = math.hypot(*sight.velocity)
            self._smoothness.add(sight.t, speed)
            self._off_squared.add(off**2)
            self._track.add(sight.t - self.took_off_t, (x, y, z))
            if director.mission.judged:
                self.vehicle_rows.append(VehicleRow(sight.t, (x, y, z), speed, director.clearance, off))

    def hand(self, sight: HandSight) -> None:
        """Take note of the hand."""
        self.coupled = sight.coupled
        error, force = math.hypot(*sight.error), math.hypot(*sight.force)
        if not (sight.coupled and self.flying and math.isfinite(error + force)):
            return
        self.director.controller(sight.error, sight.force)
        self._disagreement.add(sight.disagreement)
        self._effort.add(force)
        if self.director.mission.judged:
            self.hand_rows.append(HandRow(sight.t, error, sight.disagreement, force, sight.on_leash))

    def measures(self) -> Measures:
        """Return the flight in numbers, as far as it has come."""
        director, figures = self.director, self.director.figures
        if director.stage is Stage.WAITING:
            return Measures()
        clearance = figures.least_clearance
        return Measures(
            time_s=figures.duration,
            reached=director.leg / director.legs if director.legs else math.nan,
            rms_error_m=figures.rms_error,
            path_error_m=math.sqrt(self._off_squared.value),
            final_error_m=figures.final_error,
            landing_error_m=figures.landing_error,
            least_clearance_m=clearance if math.isfinite(clearance) else math.nan,
            collisions=figures.collisions,
            gates_missed=figures.gates_missed / figures.gates if figures.gates else math.nan,
            smoothness=self._smoothness.value(),
            disagreement_mps=self._disagreement.value,
            effort_n=self._effort.value,
        )

    def track(self) -> Track:
        """Return where it went from take-off on; while the hand did not lead it stood, or was led by others."""
        return self._track.until(self.end_t - self.took_off_t)

    def nearest(self, place: Vector3) -> str:
        """Return the name of the obstacle nearest to a place; "" without any."""
        return self._world.clearance(place)[1]

    def _mark(self, t: float, place: Vector3) -> None:
        """Keep when and where it is at the marks of the flight."""
        if math.isnan(self.took_off_t):
            self.took_off_t = t
        if math.isnan(self.held_t) and not math.isnan(self.director.figures.final_error):
            self.held_t = t
        self.end_t, self.place = t, place

    @property
    def flying(self) -> bool:
        """It has taken off and not landed yet."""
        return self.director.stage not in {Stage.WAITING, Stage.DONE}

    def _off(self, leg: int, place: Vector3) -> float:
        """Return how far a place is from the way, m; NaN where the vehicle is not on it any more or not yet."""
        stage = self.director.stage
        on_it = self.flying and stage not in {Stage.TAKING_OFF, Stage.RETURNING, Stage.FREE}
        return off_the_way(self._way, leg, place) if on_it else math.nan
