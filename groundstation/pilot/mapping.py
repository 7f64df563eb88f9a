"""From the handle to ṗ_h and p_h of equation (4), by rate control.

How far the handle is out of its centre says how fast p_h moves; p_h is the integral of that, held on a leash.
"""

from __future__ import annotations

from math import asinh, hypot, sinh, sqrt
from typing import NamedTuple

from drivers.device import Vector3
from groundstation import config
from groundstation.frames import Vector4, wrap
from groundstation.pilot.controller import vehicle_rates, world_rates

# Expo so close to 0 (or 1) that the curve is a line (a cube) to the last digits that matter.
_LINEAR = 1e-12
# A share of full speed too small to be meant.
_NOTHING = 1e-12


class Displacement(NamedTuple):
    """Where a handle is: metres from its centre in the handle frame, and its rotation about z, rad."""

    position: Vector3
    yaw: float


class RateMapping:
    """Handle displacement → ṗ_h, and back.

    Deadband and expo act on the length of the displacement, not on its parts: an oblique push keeps its
    direction at any strength, and there is no ridge along the axes.

    Args:
        settings: Frame, deadband, expo and speeds.
        workspace: Radius in which the handle moves, m.
    """

    def __init__(self, settings: config.Mapping, workspace: float) -> None:
        self._settings = settings
        self._workspace = workspace
        self._heading = settings.frame == "heading"

    def turn(self, vehicle_yaw: float) -> float:
        """Return the angle from the world's axes to those the handle moves along, rad."""
        return vehicle_yaw if self._heading else 0.0

    def rate(self, position: Vector3, yaw: float, vehicle_yaw: float) -> Vector4:
        """Return ṗ_h, world, m/s and rad/s.

        Args:
            position: Handle's displacement, handle frame, m.
            yaw: Handle's rotation, rad.
            vehicle_yaw: θ, rad.
        """
        x, y, z = position
        speed = self._settings.speed
        radius = hypot(x, y, z)
        push = self._strength(radius / self._workspace) / radius if radius > 0.0 else 0.0
        twist = self._strength(abs(yaw) / self._settings.yaw_range)
        yaw_rate = twist * speed[3] if yaw > 0.0 else -twist * speed[3]
        handle_rates = (x * push * speed[0], y * push * speed[1], z * push * speed[2], yaw_rate)
        return world_rates(handle_rates, self.turn(vehicle_yaw))

    def displacement_for(self, rate: Vector4, vehicle_yaw: float) -> Displacement:
        """Return where to hold the handle for a wished ṗ_h: the inverse of `rate`.

        A wish beyond the mapping's speeds is shortened to what the full travel gives; its direction stays.

        Args:
            rate: Wished ṗ_h, world, m/s and rad/s.
            vehicle_yaw: θ, rad.
        """
        speed = self._settings.speed
        r = vehicle_rates(rate, self.turn(vehicle_yaw))
        x, y, z = r[0] / speed[0], r[1] / speed[1], r[2] / speed[2]
        strength = hypot(x, y, z)
        reach = self._displacement(strength) * self._workspace / strength if strength > _NOTHING else 0.0
        twist = self._displacement(abs(r[3]) / speed[3]) * self._settings.yaw_range
        return Displacement((x * reach, y * reach, z * reach), twist if r[3] > 0.0 else -twist)

    def _strength(self, displacement: float) -> float:
        """Return the share of full speed for a displacement, itself a share of the full travel."""
        deadband, expo = self._settings.deadband, self._settings.expo
        s = (min(displacement, 1.0) - deadband) / (1.0 - deadband)
        return s * (1.0 - expo + expo * s * s) if s > 0.0 else 0.0

    def _displacement(self, strength: float) -> float:
        """Return the displacement for a share of full speed; nothing for nothing."""
        if strength <= _NOTHING:
            return 0.0
        deadband, expo = self._settings.deadband, self._settings.expo
        s = _cubic_root(min(strength, 1.0), expo)
        return deadband + (1.0 - deadband) * s


def _cubic_root(strength: float, expo: float) -> float:
    """Solve (1 − expo) s + expo s³ = strength, 0 ≤ s ≤ 1: the one real root, in its hyperbolic form."""
    if expo < _LINEAR:
        return strength
    if expo > 1.0 - _LINEAR:
        return strength ** (1.0 / 3.0)
    p = (1.0 - expo) / expo
    size = 2.0 * sqrt(p / 3.0)
    return size * sinh(asinh(3.0 * strength / ((1.0 - expo) * size)) / 3.0)


def advance(p_h: Vector4, rate: Vector4, dt: float) -> Vector4:
    """Integrate ṗ_h over a tick of `dt` s."""
    x, y, z, yaw = p_h
    return x + rate[0] * dt, y + rate[1] * dt, z + rate[2] * dt, wrap(yaw + rate[3] * dt)


def leashed(p_h: Vector4, p: Vector4, leash: float, leash_yaw: float) -> tuple[Vector4, bool]:
    """Pull p_h back to within the leash of p, so that a blocked drone winds nothing up.

    Args:
        p_h: Where the hand wants the drone, world, m and rad.
        p: Where it was last seen, likewise.
        leash: Largest distance in space, m.
        leash_yaw: Largest difference in yaw, rad.

    Returns:
        p_h within the leash, and whether the leash pulled.
    """
    x, y, z = p_h[0] - p[0], p_h[1] - p[1], p_h[2] - p[2]
    turn = wrap(p_h[3] - p[3])
    distance = hypot(x, y, z)
    if distance <= leash and abs(turn) <= leash_yaw:
        return p_h, False
    pull = min(1.0, leash / distance) if distance > 0.0 else 1.0
    yaw = wrap(p[3] + min(max(turn, -leash_yaw), leash_yaw))
    return (p[0] + pull * x, p[1] + pull * y, p[2] + pull * z, yaw), True
