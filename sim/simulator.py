"""One vehicle in its world, in virtual time: `step(dt)` composes autopilot, motion, air, obstacles and estimate."""

from __future__ import annotations

import math
from random import Random
from typing import Literal, NamedTuple

from sim.airframe import MODELS, Airframe, Model, load_airframe
from sim.autopilot.autopilot import Autopilot
from sim.autopilot.notices import Severity
from sim.battery import Battery
from sim.environment.collision import SKIN, Collider, bounced, impact_speed, without
from sim.environment.wind import Air
from sim.environment.world import FLOOR_NAME, World
from sim.estimator import Estimate, Estimator
from sim.kinematics import ZERO3, ZERO4, Vector3, Vector4, vehicle_rates, world_rates, wrap
from sim.models.motion import GRAVITY
from sim.momentary import Momentary
from sim.scenario import Gust, Scenario, ScenarioError

# References upward below this leave a standing vehicle where it stands, m/s.
LIFT_OFF = 0.05
# The ground is hit, not touched, above this speed, m/s. Surfaces flatter than this (cosine of slope) carry a vehicle
# that sinks onto them; one that brushes past is not carried.
_HARD_LANDING = 1.0
_CARRIES = 0.7
# How often power is reckoned, s: a battery is slow.
_DRAINS_EVERY_S = 0.02

Unit = Literal["gps", "battery"]


class Collision(NamedTuple):
    """A contact with an obstacle: when, s since start, its name, and how fast the vehicle ran into it, m/s."""

    t: float
    name: str
    speed: float


class Simulator:
    """A simulated vehicle. Deterministic: the same calls give the same flight.

    Args:
        airframe: What flies.
        scenario: Where.
        model: How it moves; the scenario's unless given.
        seed: Of turbulence and of the estimate's errors.
        start: Where it stands, world, m.

    Attributes:
        t: Seconds since start.
        p: `[x, y, z, yaw]`, the truth: world, m and rad; z is 0 on the ground, yaw within (−π, π].
        v: `[forward, left, up, yaw_rate]`, the truth, m/s and rad/s.
        estimate: What the vehicle believes of both: what it flies by and tells.
        wind: Of the last step, world, m/s.
        grounded: The ground, or an obstacle from below, carries the vehicle.
        collisions: All contacts so far.
        failed: Units that do not work.

    Raises:
        ScenarioError: An obstacle stands where the vehicle does.
    """

    def __init__(
        self,
        airframe: Airframe,
        scenario: Scenario,
        model: Model | None = None,
        *,
        seed: int = 0,
        start: Vector3 = ZERO3,
    ) -> None:
        self.airframe = airframe
        self.world = World(scenario.obstacle)
        self.t = 0.0
        self.p: Vector4 = (*start, wrap(math.radians(scenario.vehicle.yaw_deg)))
        self.v = ZERO4
        self.wind: Vector3 = ZERO3
        self.grounded = True
        self.collisions: list[Collision] = []
        self.failed: set[Unit] = set()
        self.battery = Battery(airframe.endurance_s, airframe.cells, scenario.battery)
        self._undrained = 0.0
        self._contact = scenario.contact
        self._motion = MODELS[model or scenario.vehicle.model](airframe)
        self.attitude = self._motion.attitude
        self._collider = Collider(self.world, airframe.radius)
        self.autopilot = Autopilot(airframe, self._motion, self.battery, self.p)
        self._estimator = Estimator(scenario.estimate.quality, Random(f"estimate {seed}"), self.p)
        self._air = Air(scenario.wind, self.autopilot.parameters, Random(f"air {seed}"))
        self._momentary = Momentary(
            self.autopilot.parameters,
            self.battery,
            self.gust,
            lambda lost: self.inject("gps", failed=lost),
        )
        distance, name = self.world.clearance(start)
        if distance <= airframe.radius + SKIN:
            x, y, _ = start
            raise ScenarioError(
                f"obstacle {name!r} is within {airframe.radius} m of the pad at x {x:g}, y {y:g}; move it away."
            )

    @property
    def estimate(self) -> Estimate:
        """What the vehicle believes."""
        return self._estimator.estimate

    def step(self, dt: float) -> None:
        """Advance by `dt` seconds; 0.004 is usual."""
        self.t += dt
        self._momentary.step(self.t)
        believed = self._estimator.estimate
        v_ref = self.autopilot.step(
            believed.p, believed.v, self.grounded, dt, position_valid=believed.valid_position
        )
        since = self.autopilot.took_off_t
        self.wind = self._air.step(self.p, self.v, -1.0 if since is None else self.t - since, dt)
        if self.grounded and (v_ref is None or v_ref[2] <= LIFT_OFF):
            self.v = ZERO4
            self._motion.rest()
        else:
            self._move(None if v_ref is None else self._estimator.followed(v_ref), dt)
        self._estimator.step(self.p, self.v, dt)
        self._undrained += dt
        if self._undrained >= _DRAINS_EVERY_S:
            self.battery.drain(self._thrust(), self._undrained)
            self._undrained = 0.0

    def gust(self, velocity: Vector3, duration_s: float) -> None:
        """Let one gust blow from now on: its peak, ENU, m/s, and how long it lasts from calm to calm, s."""
        since = self.autopilot.took_off_t
        self._air.add(Gust(0.0 if since is None else self.t - since, duration_s, velocity))

    def inject(self, unit: Unit, failed: bool) -> None:
        """Break a unit, or mend it.

        Without `gps` the estimate drifts away from the truth; a failed `battery` tells that it is nearly empty.
        """
        if failed:
            self.failed.add(unit)
        else:
            self.failed.discard(unit)
        self._estimator.lose_gps(lost="gps" in self.failed)
        self.battery.failed = "battery" in self.failed

    def _thrust(self) -> float:
        """Return the motors' thrust as a share of the weight, by what the accelerometer feels of it."""
        if self.grounded or not self.autopilot.armed:
            return 0.0
        x, y, z = self.attitude.specific_force()
        return math.sqrt(x * x + y * y + z * z) / GRAVITY

    def _move(self, v_ref: Vector4 | None, dt: float) -> None:
        p, v = self._motion.step(self.p, self.v, v_ref, self.wind, dt)
        x, y, z, yaw = p
        x, y, z = self._collider.travel((self.p[0], self.p[1], self.p[2]), (x, y, z))
        self.grounded = False
        if self._collider.normals:
            v = self._stopped(v, yaw)
        if z <= 0.0:
            z, v = 0.0, self._landed(v)
        self.v = v
        self.p = (x, y, z, yaw if -math.pi < yaw <= math.pi else wrap(yaw))

    def _stopped(self, v: Vector4, yaw: float) -> Vector4:
        """Bounce off the obstacles newly struck, take out what leads into those still touched, and tell."""
        collider = self._collider
        vx, vy, vz, yaw_rate = world_rates(yaw, v)
        self.grounded = v[2] < -LIFT_OFF and any(normal[2] > _CARRIES for normal in collider.normals)
        for name, normal in collider.struck:
            self._strike(name, impact_speed((vx, vy, vz), normal))
        after = bounced((vx, vy, vz), collider.struck, self._contact.restitution)
        return vehicle_rates(yaw, (*without(after, collider.normals), yaw_rate))

    def _landed(self, v: Vector4) -> Vector4:
        """Take out the velocity into the ground, which does not give it back; too much of it is a collision."""
        if v[2] < -_HARD_LANDING:
            self._strike(FLOOR_NAME, -v[2])
        self.grounded = v[2] <= 0.0
        return v[0], v[1], max(v[2], 0.0), v[3]

    def _strike(self, name: str, speed: float) -> None:
        self.collisions.append(Collision(self.t, name, speed))
        self.autopilot.say(Severity.CRITICAL, f"Collision with {name}")
        if speed > self._contact.crash_speed:
            self.autopilot.crash(name, speed)


def build(
    scenario: Scenario,
    airframe: str | None = None,
    model: Model | None = None,
    *,
    seed: int = 0,
    start: Vector3 = ZERO3,
) -> Simulator:
    """Make the simulator a mission asks for; `airframe` and `model` override what it says.

    Args:
        scenario: What the mission says of the world.
        airframe: Name or path of another.
        model: Another.
        seed: Same seed, same flight.
        start: Where the vehicle stands, world, m.

    Raises:
        ScenarioError: The airframe cannot be used, or an obstacle stands on the pad.
    """
    chosen = load_airframe(airframe or scenario.vehicle.airframe)
    return Simulator(chosen, scenario, model, seed=seed, start=start)
