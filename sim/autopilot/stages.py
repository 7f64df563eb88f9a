"""The pieces that automatic flights are made of: climb, go somewhere, wait, land. World ENU, SI units.

A stage sets the flight's target and says when it is done; whoever runs the stages steers to the target.
"""

from __future__ import annotations

from math import hypot, inf, radians
from typing import Protocol

from sim.autopilot.flight import Flight
from sim.autopilot.plan import Free3
from sim.kinematics import Vector3, wrap

_CLIMBED_M = 0.15


class Stage(Protocol):
    """A piece of an automatic flight."""

    def update(self, flight: Flight, dt: float, /) -> bool:
        """Set the target for the next step; say whether the stage is done."""
        ...


class Climb:
    """Climb straight up with MPC_TKO_SPEED.

    Args:
        height: Where to, world, m. A vehicle that is higher stays there.
    """

    def __init__(self, height: float) -> None:
        self._height = height

    def update(self, flight: Flight, _: float, /) -> bool:
        """Climb on; done when nearly there."""
        x, y = flight.target.position[:2]
        left = self._height - flight.p[2]
        if left < _CLIMBED_M:
            flight.aim((x, y, max(self._height, flight.p[2])))
            return True
        up = min(flight.parameters["MPC_TKO_SPEED"], flight.parameters["MPC_Z_P"] * left)
        flight.aim((x, y, None), velocity=(0.0, 0.0, up))
        return False


class GoTo:
    """Fly straight to a point.

    Args:
        position: Where to, world, m; an axis that is None stays as it is at the beginning.
        radius: How near is there, horizontally, m; 0: NAV_ACC_RAD. Vertically it is NAV_MC_ALT_RAD.
        yaw: To turn to, and to wait for within MIS_YAW_ERR, rad; None: MPC_YAW_MODE decides.
    """

    def __init__(self, position: Free3, radius: float = 0.0, yaw: float | None = None) -> None:
        self._position = position
        self._radius = radius
        self._yaw = yaw
        self._to: Vector3 | None = None

    def update(self, flight: Flight, _: float, /) -> bool:
        """Fly on; done when near enough."""
        get = flight.parameters
        x, y, z = self._to = self._to or _filled(self._position, flight)
        radius = self._radius or get["NAV_ACC_RAD"]
        yaw = flight.heading(x, y, radius) if self._yaw is None else self._yaw
        flight.aim(self._to, yaw)
        if hypot(x - flight.p[0], y - flight.p[1]) > radius or abs(z - flight.p[2]) > get["NAV_MC_ALT_RAD"]:
            return False
        return self._yaw is None or abs(wrap(self._yaw - flight.p[3])) <= radians(get["MIS_YAW_ERR"])


class Wait:
    """Stay.

    Args:
        seconds: How long; for ever unless given.
    """

    def __init__(self, seconds: float = inf) -> None:
        self._left = seconds

    def update(self, _: Flight, dt: float, /) -> bool:
        """Wait on."""
        self._left -= dt
        return self._left <= 0.0


class Touchdown:
    """Sink until something carries the vehicle: slower between MPC_LAND_ALT1 and MPC_LAND_ALT2, then MPC_LAND_SPEED.

    Args:
        ground: The height of the ground, world, m.
        yaw: To turn to, rad; None: it stays.
    """

    def __init__(self, ground: float, yaw: float | None = None) -> None:
        self._ground = ground
        self._yaw = yaw

    def update(self, flight: Flight, _: float, /) -> bool:
        """Sink on; done when landed."""
        get = flight.parameters
        high, low = get["MPC_LAND_ALT1"], get["MPC_LAND_ALT2"]
        share = max(0.0, min(1.0, (flight.p[2] - self._ground - low) / max(high - low, 0.01)))
        slow = get["MPC_LAND_SPEED"]
        down = slow + share * max(0.0, flight.guidance.auto.down - slow)
        x, y = flight.target.position[:2]
        flight.aim((x, y, None), self._yaw, (0.0, 0.0, -down))
        return flight.landed


def _filled(position: Free3, flight: Flight) -> Vector3:
    """Return a place with its free axes filled by where the vehicle is told to be, or is."""
    x, y, z = (
        (flight.p[axis] if old is None else old) if asked is None else asked
        for axis, (asked, old) in enumerate(zip(position, flight.target.position, strict=True))
    )
    return x, y, z
