"""One vehicle in its world, in virtual time: `step(dt)` composes autopilot, motion, wind, obstacles and battery."""

from __future__ import annotations

import math
from typing import NamedTuple

from sim.airframe import MODELS, Airframe, Model, load_airframe
from sim.autopilot.autopilot import Autopilot, Severity
from sim.battery import Battery
from sim.collision import SKIN, Collider, without
from sim.kinematics import ZERO3, ZERO4, Vector3, Vector4, vehicle_rates, world_rates, wrap
from sim.scenario import Scenario, ScenarioError
from sim.wind import wind_at
from sim.world import FLOOR_NAME, World

# References upward below this leave a standing vehicle where it stands, m/s.
LIFT_OFF = 0.05
# The ground is hit, not touched, above this speed, m/s. Surfaces flatter than this (cosine of slope) carry a vehicle
# that sinks onto them; one that brushes past is not carried.
_HARD_LANDING = 1.0
_CARRIES = 0.7


class Collision(NamedTuple):
    """A contact with an obstacle: when, s since start, and its name."""

    t: float
    name: str


class Simulator:
    """A simulated vehicle. Deterministic: the same calls give the same flight.

    Args:
        airframe: What flies.
        scenario: Where.
        model: How it moves; the scenario's unless given.

    Attributes:
        t: Seconds since start.
        p: `[x, y, z, yaw]`, world, m and rad; z is 0 on the ground, yaw within (−π, π].
        v: `[forward, left, up, yaw_rate]`, m/s and rad/s.
        wind: Of the last step, world, m/s.
        grounded: The ground, or an obstacle from below, carries the vehicle.
        collisions: All contacts so far.

    Raises:
        ScenarioError: An obstacle stands where the vehicle does.
    """

    def __init__(self, airframe: Airframe, scenario: Scenario, model: Model | None = None) -> None:
        self.airframe = airframe
        self.world = World(scenario.obstacle)
        self.t = 0.0
        self.p: Vector4 = (0.0, 0.0, 0.0, wrap(math.radians(scenario.vehicle.yaw_deg)))
        self.v = ZERO4
        self.wind: Vector3 = ZERO3
        self.grounded = True
        self.collisions: list[Collision] = []
        self.battery = Battery(airframe.endurance_s, airframe.cells)
        self._wind = scenario.wind
        self._motion = MODELS[model or scenario.vehicle.model](airframe)
        self.attitude = self._motion.attitude
        self._collider = Collider(self.world, airframe.radius)
        self.autopilot = Autopilot(airframe, self._motion, self.battery, self.p)
        distance, name = self.world.clearance(ZERO3)
        if distance <= airframe.radius + SKIN:
            raise ScenarioError(
                f"obstacle {name!r} is within {airframe.radius} m of the pad at the origin; move it away."
            )

    def step(self, dt: float) -> None:
        """Advance by `dt` seconds; 0.004 is usual."""
        self.t += dt
        v_ref = self.autopilot.step(self.p, self.v, self.grounded, dt)
        since = self.autopilot.took_off_t
        self.wind = wind_at(self._wind, -1.0 if since is None else self.t - since)
        if self.grounded and (v_ref is None or v_ref[2] <= LIFT_OFF):
            self.v = ZERO4
            self._motion.rest()
        else:
            self._move(v_ref, dt)
        self.battery.drain(dt, flying=self.autopilot.armed and not self.grounded)

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
        """Take out the velocity into the obstacles touched, and tell of those newly struck."""
        normals = self._collider.normals
        vx, vy, vz, yaw_rate = world_rates(yaw, v)
        self.grounded = v[2] < -LIFT_OFF and any(normal[2] > _CARRIES for normal in normals)
        for name in self._collider.struck:
            self._strike(name)
        return vehicle_rates(yaw, (*without((vx, vy, vz), normals), yaw_rate))

    def _landed(self, v: Vector4) -> Vector4:
        """Take out the velocity into the ground; too much of it is a collision."""
        if v[2] < -_HARD_LANDING:
            self._strike(FLOOR_NAME)
        self.grounded = v[2] <= 0.0
        return v[0], v[1], max(v[2], 0.0), v[3]

    def _strike(self, name: str) -> None:
        self.collisions.append(Collision(self.t, name))
        self.autopilot.say(Severity.CRITICAL, f"Collision with {name}")


def build(scenario: Scenario, airframe: str | None = None, model: Model | None = None) -> Simulator:
    """Make the simulator a mission asks for; `airframe` and `model` override what it says.

    Raises:
        ScenarioError: The airframe cannot be used, or an obstacle stands on the pad.
    """
    return Simulator(load_airframe(airframe or scenario.vehicle.airframe), scenario, model)
