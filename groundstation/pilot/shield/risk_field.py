"""A parametric risk field as a guard, to compare the barrier with.

After Lam, Boschloo, Mulder and van Paassen 2009, Artificial force field for haptic feedback in UAV teleoperation
(IEEE Trans. SMC-A 39:1316). Around the vehicle lies a critical region that grows with the speed by the way it takes
to stop; a thing within it has risk 1, and beyond it the risk falls as a cosine to 0. Risk pushes away from the thing.
The field knows neither delay nor forecast beyond that.
"""

from __future__ import annotations

from math import cos, pi, sin

from groundstation import config
from groundstation.frames import Vector4
from groundstation.pilot.shield.guard import Guarded, Situation

# Looked ahead by so long, s, and faded out over so much beyond the critical region, m.
_AHEAD_S = 0.3
_FADE_M = 1.0
_FELT = 1e-3


class RiskField:
    """Pushes the velocity away from risk.

    Args:
        settings: Margin and braking.
        limits: Speeds and acceleration.
    """

    def __init__(self, settings: config.Shield, limits: config.Limits) -> None:
        self._margin = settings.margin
        self._braking = settings.braking * limits.acceleration
        self._push = limits.horizontal_speed

    def reach(self, speed: float) -> float:
        """Return the gap up to which things have risk at a speed, m/s; m."""
        return self._margin + speed * _AHEAD_S + speed * speed / (2.0 * self._braking) + _FADE_M

    def guard(self, wanted: Vector4, situation: Situation) -> Guarded:
        """Return the wanted velocity and the push of the greatest risk; vehicle's axes, m/s and rad/s."""
        x, y, z = situation.velocity
        greatest, thing = _FELT, None
        for near in situation.near:
            nx, ny, nz = near.normal
            closing = max(0.0, -(nx * x + ny * y + nz * z))
            risk = self._risk(near.gap - (self._margin if near.solid else 0.0), closing)
            if risk > greatest:
                greatest, thing = risk, near
        if thing is None:
            return Guarded(wanted)
        (nx, ny, nz), push = thing.normal, greatest * self._push
        c, s = cos(situation.yaw), sin(situation.yaw)
        forward, left, up, turn = wanted
        return Guarded(
            (forward + push * (c * nx + s * ny), left + push * (c * ny - s * nx), up + push * nz, turn),
            thing.name,
        )

    def _risk(self, gap: float, closing: float) -> float:
        """Return the risk of a thing, 0 to 1."""
        beyond = gap - closing * _AHEAD_S - closing * closing / (2.0 * self._braking)
        if beyond <= 0.0:
            return 1.0
        return 0.5 * (1.0 + cos(pi * beyond / _FADE_M)) if beyond < _FADE_M else 0.0
