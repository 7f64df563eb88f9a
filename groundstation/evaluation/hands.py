"""Who holds the handle: a simulated operator who flies a mission, or an adversary who flies into things.

Either only says where the hand wants the handle to be; the arm (`drivers.arm`) takes it there, and yields to force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random
from typing import Protocol

from drivers.device import ZERO3
from groundstation.frames import Vector3
from groundstation.pilot.mapping import Displacement, RateMapping
from groundstation.pilot.sight import VehicleSample
from sim.operator import Operator

CENTRE = Displacement(ZERO3, 0.0)


class Hand(Protocol):
    """Decides 50 times a second where the handle should be, while the vehicle follows it."""

    def decide(self, t: float, vehicle: VehicleSample) -> Displacement:
        """Return where the handle should be, as the vehicle was last seen; `t` in s."""
        ...


class OperatorHand:
    """A simulated operator whose wish is turned back through the rate mapping.

    Args:
        operator: Looks and decides.
        mapping: The one the pilot flies with.
    """

    def __init__(self, operator: Operator, mapping: RateMapping) -> None:
        self._operator = operator
        self._mapping = mapping

    def decide(self, t: float, vehicle: VehicleSample) -> Displacement:
        """Return where the handle should be for what the operator wishes."""
        (vx, vy, vz, _), yaw = vehicle.velocity, vehicle.position[3]
        wish = self._operator.decide(t, vehicle.position, (vx, vy, vz))
        return self._mapping.displacement_for(wish, yaw)


class Adversary:
    """Full stick in directions that change at random times; half of them lead straight at something.

    Args:
        mapping: The one the pilot flies with.
        workspace: Radius in which the handle moves, m.
        yaw_range: Rotation of the handle that gives the full yaw rate, rad.
        aims: Points to be flown into, world, m; none: all directions are random.
        seed: The same seed wants the same.
    """

    _SHORTEST_S, _LONGEST_S = 0.3, 4.0
    _AIMED, _TURNING = 0.5, 0.3
    _FAST = 1e3

    def __init__(
        self,
        mapping: RateMapping,
        workspace: float,
        yaw_range: float,
        aims: Sequence[Vector3],
        seed: int,
    ) -> None:
        self._mapping = mapping
        self._workspace = workspace
        self._yaw_range = yaw_range
        self._aims = aims
        self._random = Random(f"adversary {seed}")
        self._until = -math.inf
        self._aim: Vector3 | None = None
        self._wanted = CENTRE

    def decide(self, t: float, vehicle: VehicleSample) -> Displacement:
        """Return the end of the handle's travel."""
        if t >= self._until:
            self._choose(t)
        if self._aim is None:
            return self._wanted
        x, y, z, yaw = vehicle.position
        to = (self._aim[0] - x, self._aim[1] - y, self._aim[2] - z)
        scale = self._FAST / max(math.hypot(*to), 1e-9)
        wish = (scale * to[0], scale * to[1], scale * to[2], 0.0)
        return Displacement(self._mapping.displacement_for(wish, yaw).position, self._wanted.yaw)

    def _choose(self, t: float) -> None:
        """Want something else for a while."""
        random = self._random
        self._until = t + random.uniform(self._SHORTEST_S, self._LONGEST_S)
        x, y, z = (random.gauss(0.0, 1.0) for _ in range(3))
        reach = self._workspace / math.hypot(x, y, z)
        turning = random.random() < self._TURNING
        yaw = random.choice((-1.0, 1.0)) * self._yaw_range if turning else 0.0
        self._wanted = Displacement((reach * x, reach * y, reach * z), yaw)
        aimed = random.random() < self._AIMED and len(self._aims) > 0
        self._aim = random.choice(self._aims) if aimed else None
