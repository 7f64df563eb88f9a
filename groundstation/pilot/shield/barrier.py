"""The shield: keeps the velocity asked for out of obstacles and fence, and above the floor, and no more than that.

A control-barrier guard (Ames et al. 2019, Control barrier functions: theory and applications). To a plane at a gap
h a vehicle that needs a time T to react and then brakes with a may fly at

    s(h) = a (√(T² + 2 h / a) − T),        h = s T + s² / (2 a)

so the velocity is kept within n · u ≥ −s(h) for each thing near, with n its way out; of all such velocities the one
nearest to what the hand asks for is flown. The gap is that of the forecast: where the vehicle will be when the
setpoint reaches it, so the delay is in it; T and a are the vehicle's response and the limits; the push of the wind,
and a speed that is too high already, are held against.
"""

from __future__ import annotations

from math import cos, sin, sqrt

from drivers.device import Vector3
from groundstation import config
from groundstation.frames import Vector4
from groundstation.pilot.margin import Lags
from groundstation.pilot.shield.guard import Guarded, Situation
from groundstation.pilot.shield.halfspaces import Halfspace, nearest_within
from groundstation.pilot.shield.nearby import Near

# Out of a margin that was entered all the same, at so much a metre and at most so fast, 1/s and m/s.
_RETREAT, _RETREAT_SPEED = 1.0, 0.4
# How hard a speed that is too high already is held against: m/s a m/s.
_AGAINST = 1.0
# The setpoint is sent at 50 Hz: it waits a period at most.
_SENDING_S = 0.02
_FELT = 1e-3


class Barrier:
    """The control-barrier guard.

    Args:
        settings: Margin and braking.
        limits: Acceleration and jerk that setpoints keep to.
        lags: The vehicle's response, compensation included.
    """

    def __init__(self, settings: config.Shield, limits: config.Limits, lags: Lags) -> None:
        self._margin = settings.margin
        self._braking = settings.braking * limits.acceleration
        # From full acceleration towards a thing to full braking takes 2 a / j; half of that is lost.
        self._delay_s = _SENDING_S + limits.acceleration / limits.jerk
        forward, left, up = lags[:3]
        self._gains = (forward.gain, left.gain, up.gain)
        self._times = (forward.time, left.time, up.time)
        self._gain = max(1.0, *self._gains)
        self._slowest_s = self._delay_s + max(self._times)

    def reach(self, speed: float) -> float:
        """Return the gap in which a vehicle told this speed, or at it, m/s, stops whatever way it flies; m."""
        top = self._gain * speed
        return self._margin + top * self._slowest_s + top * top / (2.0 * self._braking)

    def guard(self, wanted: Vector4, situation: Situation) -> Guarded:
        """Return the velocity nearest to the wanted one that is safe; vehicle's axes, m/s and rad/s."""
        forward, left, up, turn = wanted
        near, velocity, yaw, push = situation
        planes: list[Halfspace] = []
        by, worst = "", _FELT
        c, s = cos(yaw), sin(yaw)
        for thing in near:
            nx, ny, nz = thing.normal
            away = (c * nx + s * ny, c * ny - s * nx, nz)
            plane = self._plane(thing, away, _along(thing.normal, velocity), _along(thing.normal, push))
            planes.append(plane)
            (a, b, d), offset = plane
            excess = offset - (a * forward + b * left + d * up)
            if excess > worst:
                by, worst = thing.name, excess
        if not by:
            return Guarded(wanted)
        found = nearest_within((forward, left, up), planes)
        # Between things that ask for opposite ways nothing is right but to stand.
        x, y, z = found if found is not None else (0.0, 0.0, 0.0)
        return Guarded((x, y, z, turn), by)

    def _plane(self, thing: Near, away: Vector3, leaving: float, pushed: float) -> Halfspace:
        """Return the half-space of setpoints, vehicle's axes, that one thing leaves.

        Args:
            thing: To keep away from.
            away: Unit vector away from it, vehicle's axes.
            leaving: Speed away from it, m/s.
            pushed: Disturbing acceleration away from it, m/s².
        """
        (x, y, z), (p, q, r), (i, j, k) = away, self._gains, self._times
        lag = i * x * x + j * y * y + k * z * z
        gap = thing.gap - self._margin if thing.solid else thing.gap
        bound = self._speed(gap, self._delay_s + lag)
        # The wind's push shifts the velocity by push · lag; only one towards the thing is held against.
        if pushed < 0.0:
            bound += pushed * lag
        too_fast = -leaving - max(bound, 0.0)
        if too_fast > 0.0:
            bound -= _AGAINST * too_fast
        a, b, d = p * x, q * y, r * z
        size = sqrt(a * a + b * b + d * d)
        return (a / size, b / size, d / size), -bound / size

    def _speed(self, gap: float, reaction: float) -> float:
        """Return the speed that may be flown towards a thing, m/s; negative: away from it."""
        if gap < 0.0:
            return max(_RETREAT * gap, -_RETREAT_SPEED)
        braking = self._braking
        return braking * (sqrt(reaction * reaction + 2.0 * gap / braking) - reaction)


def _along(direction: Vector3, vector: Vector3) -> float:
    return direction[0] * vector[0] + direction[1] * vector[1] + direction[2] * vector[2]
