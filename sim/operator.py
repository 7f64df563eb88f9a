"""A simulated operator: decides, as a person would, which way and how fast the vehicle should go.

It sees the vehicle late, carries its motion on in mind, steers along a route, slows before corners, settles
on the target and learns what steady push holds against wind. What it returns is a wish, not a handle: an arm
turns it into motion elsewhere.

Near the crossover ω_c a person makes the whole loop look like ω_c e^(−τs)/s, and adds a remnant that no
linear model explains (McRuer and Jex 1967, A review of quasi-linear pilot models). The vehicle integrates the
wish, so the person is a gain ω_c on the position error.
"""

from __future__ import annotations

import math
import random
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

Vector3 = tuple[float, float, float]
Vector4 = tuple[float, float, float, float]

ZERO3: Vector3 = (0.0, 0.0, 0.0)
LET_GO: Vector4 = (0.0, 0.0, 0.0, 0.0)
NEGLIGIBLE_LEG = 0.05
STEEP_LEG = 0.2
ARRIVED_WITHIN = 0.2


@dataclass(frozen=True, slots=True)
class Person:
    """How somebody steers.

    Attributes:
        cruise: Speed that is never wished beyond, m/s.
        reaction: From light to decision, s: McRuer's effective delay without the arm's part.
        ahead: How far beyond the present the seen motion is carried on in mind, s.
        lag: Time in which the vehicle is believed to follow, s.
        crossover: ω_c, wish a metre of error, 1/s.
        trim: How fast a steady push is learnt from motion other than expected, 1/s.
        trim_limit: Largest steady push, m/s.
        slowing: Comfortable deceleration, m/s².
        slack: How far the vehicle may swing out of a corner, m.
        settle_within: Distance before the target at which the route ends and holding begins, m.
        remnant: Standard deviation of the wish's noise at rest, m/s.
        remnant_share: What it grows by, as a share of the wished speed (Harris and Wolpert 1998,
            Signal-dependent noise determines motor planning).
        remnant_time: Correlation time of the noise, s.
        face_along: Turn the vehicle's front along the route; else yaw is left alone.
        turn_gain: Yaw rate a radian of yaw error, 1/s.
        turn_rate: Largest yaw rate wished, rad/s.
        recovers: After a coupling was lost and could be had again, so long until it is asked for, s.
        arm_mass: Of hand and handle, kg.
        arm_stiffness: Of the arm that holds the handle, N/m.
    """

    cruise: float = 1.2
    reaction: float = 0.2
    ahead: float = 0.4
    lag: float = 0.5
    crossover: float = 0.8
    trim: float = 0.4
    trim_limit: float = 0.5
    slowing: float = 0.5
    slack: float = 0.15
    settle_within: float = 0.8
    remnant: float = 0.02
    remnant_share: float = 0.05
    remnant_time: float = 0.15
    face_along: bool = False
    turn_gain: float = 1.0
    turn_rate: float = 0.5
    recovers: float = 2.0
    arm_mass: float = 0.554
    arm_stiffness: float = 135.0


class Leg(NamedTuple):
    """A straight piece of the route: where it starts, its unit direction, its length, how it is left.

    Attributes:
        ends_before: The next piece takes over this far before the end, m.
        exit_speed: Speed to have by then, m/s.
    """

    start: Vector3
    direction: Vector3
    length: float
    ends_before: float
    exit_speed: float


class Operator:
    """Steers a vehicle through a route to a target and keeps it there.

    Args:
        route: Points to pass, world ENU, m.
        target: Where to stay, world ENU, m.
        person: How.
        seed: Of the noise; the same seed decides the same.
    """

    def __init__(
        self, route: Sequence[Vector3], target: Vector3, person: Person | None = None, seed: int = 0
    ) -> None:
        self._person = person or Person()
        self._points = (*route, target)
        self._yaw = math.nan
        self._random = random.Random(seed)
        self._sight: deque[tuple[float, Vector4, Vector3]] = deque()
        self._legs: list[Leg] | None = None
        self._leg = 0
        self._expected = ZERO3
        self._trim = ZERO3
        self._noise = ZERO3
        self._last_t = -math.inf
        self._arrived = False
        self._distance = math.inf

    def go(self, route: Sequence[Vector3], target: Vector3, yaw: float = math.nan) -> None:
        """Turn to another route, from wherever the vehicle is seen then; what was learnt of the wind stays.

        Args:
            route: Points to pass, world ENU, m.
            target: Where to stay, likewise.
            yaw: Where to turn the vehicle's front, rad; NaN: as the person likes.
        """
        self._points, self._yaw = (*route, target), yaw
        self._legs, self._leg = None, 0
        self._arrived, self._distance = False, math.inf

    def forget(self) -> None:
        """Lose sight of the vehicle, as while it is flown by another: what was seen and expected is gone."""
        self._sight.clear()
        self._expected = ZERO3
        self._last_t = -math.inf
        self._legs, self._leg = None, 0
        self._arrived, self._distance = False, math.inf

    def adapt(self, person: Person) -> None:
        """Steer as `person` from now on: the same one, who has got used to another link."""
        self._person = person

    @property
    def distance(self) -> float:
        """How far the vehicle is believed to be from the end of the route, m; infinite on the way there."""
        return self._distance

    @property
    def leg(self) -> int:
        """Which leg is flown, from 0; `legs` once the target is being held."""
        return self._leg

    @property
    def legs(self) -> int:
        """How many legs there are from where the vehicle was first seen; 0 before that."""
        return len(self._legs or ())

    @property
    def arrived(self) -> bool:
        """The target is being held, and the vehicle is believed to be within 0.2 m of it."""
        return self._arrived

    def decide(self, t: float, position_world: Vector4, velocity_world: Vector3) -> Vector4:
        """Look at the vehicle and decide.

        Args:
            t: Now, s; never goes back.
            position_world: What the screen shows of it: x, y, z, yaw; m and rad, ENU.
            velocity_world: Its velocity, m/s, ENU.

        Returns:
            Wished velocity vx, vy, vz, m/s, world ENU, no longer than the cruise speed, and yaw rate, rad/s.
            All zero where nothing is to be seen: before the reaction time has passed, or where the state is
            not finite.
        """
        dt = max(t - self._last_t, 0.0) if math.isfinite(self._last_t) else 0.0
        self._last_t = t
        if not all(map(math.isfinite, (*position_world, *velocity_world))):
            self._sight.clear()
            return LET_GO
        person = self._person
        self._sight.append((t, position_world, velocity_world))
        seen = self._look(t - person.reaction)
        if seen is None:
            return LET_GO
        (x, y, z, yaw), velocity = seen
        place = _plus((x, y, z), velocity, person.reaction + person.ahead)
        if self._legs is None:
            self._legs = plan((x, y, z), self._points, person)
        wish = self._steer(self._legs, place, velocity, dt)
        wish = within(_plus(wish, self._tremble(math.hypot(*wish), dt)), person.cruise)
        return (*wish, self._turn(self._legs, yaw))

    def _look(self, until: float) -> tuple[Vector4, Vector3] | None:
        sight = self._sight
        while len(sight) > 1 and sight[1][0] <= until:
            sight.popleft()
        t, position, velocity = sight[0]
        return (position, velocity) if t <= until else None

    def _steer(self, legs: list[Leg], place: Vector3, velocity: Vector3, dt: float) -> Vector3:
        """Return the wish without noise: along the route, back to it, and the push learnt so far.

        The person expects the vehicle to follow the wanted velocity with a lag, and takes what it does
        otherwise for wind or for a handle that is pushed: trim' = trim_rate (expected − seen).
        """
        person = self._person
        while self._leg < len(legs) and to_end(legs[self._leg], place) <= legs[self._leg].ends_before:
            self._leg += 1
        if self._leg < len(legs):
            error, onward = follow(legs[self._leg], place, person)
        else:
            error, onward = _minus(self._points[-1], place), ZERO3
        self._distance = math.hypot(*error) if self._leg == len(legs) else math.inf
        self._arrived = self._distance <= ARRIVED_WITHIN
        wanted = within(_plus(onward, error, person.crossover), person.cruise)
        surprise = _minus(self._expected, velocity)
        self._trim = within(_plus(self._trim, surprise, person.trim * dt), person.trim_limit)
        share = -math.expm1(-dt / (person.lag + person.reaction))
        self._expected = _plus(self._expected, _minus(wanted, self._expected), share)
        return within(_plus(wanted, self._trim), person.cruise)

    def _tremble(self, speed: float, dt: float) -> Vector3:
        """Step the remnant, an Ornstein-Uhlenbeck process: its spread does not depend on dt."""
        person = self._person
        keep = math.exp(-dt / person.remnant_time)
        fresh = (person.remnant + person.remnant_share * speed) * math.sqrt(1.0 - keep * keep)
        gauss = self._random.gauss
        x, y, z = self._noise
        self._noise = (
            keep * x + fresh * gauss(0.0, 1.0),
            keep * y + fresh * gauss(0.0, 1.0),
            keep * z + fresh * gauss(0.0, 1.0),
        )
        return self._noise

    def _turn(self, legs: list[Leg], yaw: float) -> float:
        person, wanted = self._person, self._yaw
        if math.isnan(wanted):
            if not person.face_along or self._leg == len(legs):
                return 0.0
            x, y, _ = legs[self._leg].direction
            if math.hypot(x, y) < STEEP_LEG:
                return 0.0
            wanted = math.atan2(y, x)
        error = math.remainder(wanted - yaw, math.tau)
        return max(-person.turn_rate, min(person.turn_rate, person.turn_gain * error))


def plan(start: Vector3, points: Sequence[Vector3], person: Person) -> list[Leg]:
    """Return the legs from `start` through `points`; pieces too short to have a direction are left out.

    A corner of angle φ is passed at slack / (lag sin φ): the part v sin φ of the old velocity that no longer
    fits dies out within the vehicle's lag, so that is how far it swings out.
    """
    pieces: list[tuple[Vector3, Vector3, float]] = []
    for point in points:
        length = math.dist(start, point)
        if length < NEGLIGIBLE_LEG:
            continue
        pieces.append((start, _scaled(_minus(point, start), 1.0 / length), length))
        start = point
    legs: list[Leg] = []
    for index, (begin, direction, length) in enumerate(pieces):
        if index + 1 == len(pieces):
            before, speed = person.settle_within, person.crossover * person.settle_within
        else:
            cosine = _dot(direction, pieces[index + 1][1])
            sine = 1.0 if cosine <= 0.0 else math.sqrt(max(0.0, 1.0 - cosine * cosine))
            before, speed = 0.0, person.slack / max(person.lag * sine, 1e-9)
        legs.append(Leg(begin, direction, length, before, min(speed, person.cruise)))
    return legs


def follow(leg: Leg, place: Vector3, person: Person) -> tuple[Vector3, Vector3]:
    """Return how far to the side the leg lies, m, and the velocity along it, m/s: v² = v_exit² + 2 a s."""
    left = to_end(leg, place)
    nearest = _plus(leg.start, leg.direction, leg.length - left)
    braking = max(left - leg.ends_before, 0.0)
    speed = min(person.cruise, math.sqrt(leg.exit_speed**2 + 2.0 * person.slowing * braking))
    return _minus(nearest, place), _scaled(leg.direction, speed)


def within(vector: Vector3, length: float) -> Vector3:
    """Return the vector, shortened to `length` where it is longer; its direction stays."""
    norm = math.hypot(*vector)
    return vector if norm <= length else _scaled(vector, length / norm)


def to_end(leg: Leg, place: Vector3) -> float:
    """Return how much of the leg is left, m; negative beyond its end."""
    return leg.length - _dot(_minus(place, leg.start), leg.direction)


def _minus(a: Vector3, b: Vector3) -> Vector3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _scaled(a: Vector3, factor: float) -> Vector3:
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def _plus(a: Vector3, b: Vector3, factor: float = 1.0) -> Vector3:
    return (a[0] + b[0] * factor, a[1] + b[1] * factor, a[2] + b[2] * factor)


def _dot(a: Vector3, b: Vector3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
