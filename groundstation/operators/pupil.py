"""A simulated operator who flies a mission: sees what is to be done next, as the screen tells it, and steers there.

How somebody steers is `sim.operator`'s; here it is decided where to, and when there is nothing left but to land.
"""

from __future__ import annotations

import math

from groundstation.frames import Vector3, Vector4
from groundstation.training.director import Director, Stage
from groundstation.training.mission import Fence, Mission, Waypoint
from sim.operator import LET_GO, Operator, Person
from sim.people import accustomed
from sim.scenario import Pad

# Nearer than this to the end of a route it counts as reached; the longer it is tried, the more is good enough.
_NEAR_M, _YIELDS_MPS = 0.15, 0.02
# So long it must stay there, s.
_SETTLED_S = 0.8
# So high above a pad the descent by hand ends, m, and never nearer to the floor than the margin.
_LOW_M, _FLOOR_MARGIN_M = 0.6, 0.15
# Not asked for longer than this the operator was not flying, s.
_BLIND_S = 0.5
# People notice a change of the round trip from this on, s.
_NOTICED_S = 0.02


class Pupil:
    """Flies one mission.

    Args:
        mission: What is flown.
        person: Who flies.
        seed: Of the noise; the same seed flies the same.

    Attributes:
        through: All is flown: what is left is to let go and land.
    """

    def __init__(self, mission: Mission, person: Person, seed: int) -> None:
        self._mission, self._person = mission, person
        self._points = _points(mission)
        self._operator = Operator((), (0.0, 0.0, mission.takeoff_altitude_m), person, seed)
        self._end = -1
        self._descending: bool | None = None
        self._round_trip = 0.0
        self._last_t = -math.inf
        self._near_t = self._tried_t = math.inf
        self.through = False

    def decide(
        self, t: float, position: Vector4, velocity: Vector3, director: Director, round_trip: float
    ) -> Vector4:
        """Look at the vehicle and at what the mission asks for next, and decide.

        Args:
            t: Now, s; never goes back.
            position: Of the vehicle as the screen shows it: x, y, z, yaw; world, m and rad.
            velocity: Likewise, m/s.
            director: Knows what is next.
            round_trip: Of the link as it is shown, s; NaN where it is not.

        Returns:
            Wished velocity vx, vy, vz, m/s, world, and yaw rate, rad/s.
        """
        operator = self._operator
        if t - self._last_t > _BLIND_S:
            operator.forget()
            self._end, self._descending = -1, None
        self._last_t = t
        if abs(round_trip - self._round_trip) > _NOTICED_S:
            self._round_trip = round_trip
            operator.adapt(accustomed(self._person, round_trip))
        self._choose(t, position, director)
        if self.through:
            return LET_GO
        wish = operator.decide(t, position, velocity)
        self._judge(t, operator.distance)
        return wish

    def _choose(self, t: float, position: Vector4, director: Director) -> None:
        """Turn to what is next where that has changed."""
        settled = t - self._near_t >= _SETTLED_S
        if director.at_the_end or director.stage is Stage.DONE:
            self._land(settled, position)
        elif director.leg > self._end:
            self._fly(director.leg, self._next_stop(director.leg))
        elif settled and director.leg < self._end:
            # It was believed to be passed and was not: this time it is stopped at.
            self._fly(director.leg, director.leg)

    def _next_stop(self, leg: int) -> int:
        """Return the first point from `leg` on at which something is to be waited for."""
        points = self._points
        while leg + 1 < len(points) and not points[leg].hold_s and points[leg].yaw_deg is None:
            leg += 1
        return leg

    def _fly(self, leg: int, end: int) -> None:
        """Fly to the point `leg` and on to `end`, and stay there."""
        points = self._points
        yaw_deg = points[end].yaw_deg
        yaw = math.nan if yaw_deg is None else math.radians(yaw_deg)
        self._turn_to([point.at for point in points[leg : end + 1]], yaw)
        self._end = end

    def _land(self, settled: bool, position: Vector4) -> None:
        """Go above the pad, then down to it; where there is none, land at once."""
        pad = self._mission.landing_pad
        if pad is None:
            self.through = True
        elif self._descending is None:
            x, y, _ = pad.position
            above = math.hypot(position[0] - x, position[1] - y) <= 0.5 * pad.radius
            self._descend(pad) if above else self._turn_to([self._mission.way[-1]])
            self._descending = above
        elif settled and self._descending:
            self.through = True
        elif settled:
            self._descending = True
            self._descend(pad)

    def _descend(self, pad: Pad) -> None:
        x, y, z = pad.position
        floor = (self._mission.fence or Fence()).floor
        self._turn_to([(x, y, max(z + _LOW_M, floor + _FLOOR_MARGIN_M))])

    def _turn_to(self, points: list[Vector3], yaw: float = math.nan) -> None:
        self._operator.go(points[:-1], points[-1], yaw)
        self._near_t, self._tried_t = math.inf, math.inf

    def _judge(self, t: float, distance: float) -> None:
        """Note since when the end of the route has been reached, as far as the operator can tell."""
        if not math.isfinite(distance):
            return
        self._tried_t = min(self._tried_t, t)
        near = distance <= _NEAR_M + _YIELDS_MPS * (t - self._tried_t)
        self._near_t = min(self._near_t, t) if near else math.inf


def _points(mission: Mission) -> tuple[Waypoint, ...]:
    """Return the points of the route and the target as one more."""
    target = mission.target
    if target is None:
        return mission.waypoints
    last = Waypoint(target.position, target.radius, target.hold_s, target.yaw_deg)
    return (*mission.waypoints, last)
