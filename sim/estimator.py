"""What the vehicle believes of its motion: it lags, and wanders as the estimate of a real autopilot does. Seeded.

By axis, the velocity's error e is an Ornstein-Uhlenbeck process and the position's error d its leaky integral,

    ė = −e/T_e + noise,    ḋ = e − d/T_d,

so that the two belong together, as in a filter that corrects its position slowly. Both are advanced exactly:
their spread does not depend on the step. World ENU, vehicle FLU, SI units.
"""

from __future__ import annotations

from math import cos, exp, expm1, pi, radians, sin, sqrt
from random import Random
from typing import NamedTuple

from sim.kinematics import ZERO4, Vector4, wrap

# The sensors that correct a filter come no faster, s; in between its errors are held.
_EVERY_S = 0.02
_NEARLY = 1e-9
# Without GPS PX4 trusts its position for this long, s (EKF2_NOAID_TOUT).
COASTS_S = 5.0


class Wander(NamedTuple):
    """How an axis wanders.

    Attributes:
        spread: Standard deviation of the position's error in the long run, m.
        time: T_d, s.
        velocity_time: T_e, s.
    """

    spread: float
    time: float
    velocity_time: float

    @property
    def velocity_spread(self) -> float:
        """Standard deviation of e, m/s: that which makes d wander by `spread`, σ_d² = σ_e² T_d² T_e/(T_d + T_e)."""
        slow, fast = self.time, self.velocity_time
        return self.spread / (slow * sqrt(fast / (slow + fast)))

    @property
    def law(self) -> tuple[float, float, float]:
        """Spread of e, m/s, 1/T_e and 1/T_d, 1/s."""
        return self.velocity_spread, 1.0 / self.velocity_time, 1.0 / self.time


class Quality(NamedTuple):
    """How good an estimate is.

    Attributes:
        level: Wander east and north.
        height: Wander up: where a barometer gives the height, its drift.
        yaw: Standard deviation of the heading's error, rad, which comes and goes in `yaw_time`, s.
        lag: Time constant with which position and velocity follow the truth, s.
    """

    level: Wander
    height: Wander
    yaw: float
    yaw_time: float
    lag: float


_PERFECT = "ideal"
# Positions count from where the filter began, so what counts is how far it wanders, not how far off the globe it is.
# `gps`: a receiver like u-blox's NEO-M8 (its datasheet: 2.5 m CEP in a day, velocity 0.05 m/s), of which the wander
# within minutes is a part; a barometer for the height; a magnetometer. `rtk`: a receiver like u-blox's ZED-F9P with
# corrections (datasheet: 0.01 m CEP), two antennas for the heading. Times and lags are estimates.
QUALITIES: dict[str, Quality] = {
    "ideal": Quality(Wander(0.0, 10.0, 2.0), Wander(0.0, 10.0, 2.0), 0.0, 30.0, 0.0),
    "rtk": Quality(Wander(0.012, 10.0, 2.0), Wander(0.02, 10.0, 2.0), radians(0.3), 30.0, 0.02),
    "gps": Quality(Wander(0.4, 60.0, 3.0), Wander(0.3, 120.0, 3.0), radians(2.0), 60.0, 0.05),
}
# Dead reckoning after the loss of GPS: what an error of half a degree in the attitude does to the velocity, about
# 0.8 m/s after 10 s; nothing holds the position. Spread of e, 1/T_e, 1/T_d.
_LOST = (1.5, 1.0 / 60.0, 0.0)


class Estimate(NamedTuple):
    """What the vehicle believes.

    Attributes:
        p: `[x, y, z, yaw]`, world, m and rad; yaw within (−π, π].
        v: `[forward, left, up, yaw_rate]`, m/s and rad/s.
        valid_position: The filter trusts its position.
    """

    p: Vector4
    v: Vector4
    valid_position: bool = True


class Estimator:
    """The filter of one vehicle.

    Args:
        quality: A name in `QUALITIES`.
        random: Where chance comes from.
        start: Where the vehicle stands.

    Attributes:
        estimate: The newest.
    """

    def __init__(self, quality: str, random: Random, start: Vector4) -> None:
        self.estimate = Estimate(start, ZERO4)
        self._quality = QUALITIES[quality]
        self._gauss = random.gauss
        self._level, self._height = self._quality.level.law, self._quality.height.law
        self._yaw_error = 0.0
        self._east, self._north, self._up = _Axis(random), _Axis(random), _Axis(random)
        self._seen = (0.0, 0.0, 0.0)
        self._yaw = (cos(start[3]), sin(start[3]))
        self._turn = (1.0, 0.0)
        self._step_s = self._keep = 0.0
        self._waited = 0.0
        self._lost_s: float | None = None
        self._truth = quality == _PERFECT

    def lose_gps(self, *, lost: bool) -> None:
        """Lose the receiver, or have it back: then the filter is set to what it says."""
        if lost == (self._lost_s is not None):
            return
        self._lost_s = 0.0 if lost else None
        self._truth = self._quality is QUALITIES[_PERFECT] and not lost
        if not lost:
            self._east.reset()
            self._north.reset()

    def step(self, p: Vector4, v: Vector4, dt: float) -> Estimate:
        """Advance by `dt` seconds to where the vehicle is now, and return what it believes."""
        if self._truth:
            self.estimate = Estimate(p, v)
            return self.estimate
        self._waited += dt
        if self._waited >= _EVERY_S - _NEARLY:
            self._wander(self._waited)
            self._waited = 0.0
        keep, lag = self._kept(dt), self._quality.lag
        c, s = cos(p[3]), sin(p[3])
        forward, left, up, yaw_rate = v
        x, y, z = self._seen
        east, north = c * forward - s * left, s * forward + c * left
        x, y, z = self._seen = (east + keep * (x - east), north + keep * (y - north), up + keep * (z - up))
        axis_x, axis_y, axis_z = self._east, self._north, self._up
        a, b, climb = x + axis_x.e, y + axis_y.e, z + axis_z.e
        forward, left = c * a + s * b, c * b - s * a
        turn_c, turn_s = self._turn
        yaw = p[3] + self._yaw_error
        self._yaw = (c, s)
        self.estimate = Estimate(
            # The low-passed position is p − lag · (the low-passed velocity): they lag alike.
            (
                p[0] - lag * x + axis_x.d,
                p[1] - lag * y + axis_y.d,
                p[2] - lag * z + axis_z.d,
                yaw if -pi < yaw <= pi else wrap(yaw),
            ),
            (turn_c * forward + turn_s * left, turn_c * left - turn_s * forward, climb, yaw_rate),
            self._lost_s is None or self._lost_s < COASTS_S,
        )
        return self.estimate

    def followed(self, v_ref: Vector4) -> Vector4:
        """Return the true velocities that a vehicle strives for when it is asked for `v_ref`.

        Its velocity loop brings the estimated velocity to the reference, so the true one falls short by the error,
        and lies on axes that are turned by the error of the heading.
        """
        if self._truth:
            return v_ref
        forward, left, up, yaw_rate = v_ref
        (c, s), (turn_c, turn_s) = self._yaw, self._turn
        east, north = self._east.e, self._north.e
        return (
            turn_c * forward - turn_s * left - c * east - s * north,
            turn_s * forward + turn_c * left - c * north + s * east,
            up - self._up.e,
            yaw_rate,
        )

    def _kept(self, dt: float) -> float:
        """Return what a step of `dt` leaves of what lags."""
        if dt != self._step_s:
            self._step_s = dt
            self._keep = exp(-dt / self._quality.lag) if self._quality.lag > 0.0 else 0.0
        return self._keep

    def _wander(self, dt: float) -> None:
        """Move all errors on by `dt` seconds."""
        quality = self._quality
        keep = exp(-dt / quality.yaw_time)
        fresh = quality.yaw * sqrt(1.0 - keep * keep)
        self._yaw_error = keep * self._yaw_error + fresh * self._gauss(0.0, 1.0)
        self._turn = (cos(self._yaw_error), sin(self._yaw_error))
        level = self._level
        if self._lost_s is not None:
            self._lost_s += dt
            level = _LOST
        self._east.advance(*level, dt)
        self._north.advance(*level, dt)
        self._up.advance(*self._height, dt)


class _Axis:
    """The errors of one axis: `e` of the velocity, m/s, and `d` of the position, m. They begin at zero."""

    def __init__(self, random: Random) -> None:
        self.e = self.d = 0.0
        self._gauss = random.gauss
        self._law = (0.0, 0.0, 0.0, 0.0)
        self._exact = (0.0,) * 6

    def reset(self) -> None:
        """Begin anew."""
        self.e = self.d = 0.0

    def advance(self, spread: float, a: float, b: float, dt: float) -> None:
        """Move on by `dt`, exactly.

        Args:
            spread: Standard deviation of e in the long run, m/s.
            a: 1/T_e.
            b: 1/T_d, other than a.
            dt: s.
        """
        if self._law != (spread, a, b, dt):
            self._law = (spread, a, b, dt)
            self._exact = _discrete(spread, a, b, dt)
        keep_e, keep_d, carried, first, both, rest = self._exact
        noise = self._gauss(0.0, 1.0)
        self.d = keep_d * self.d + carried * self.e + both * noise + rest * self._gauss(0.0, 1.0)
        self.e = keep_e * self.e + first * noise


def _discrete(
    spread: float, a: float, b: float, dt: float
) -> tuple[float, float, float, float, float, float]:
    """Return what keeps of e, of d, what e adds to d, and the Cholesky factors of the noise of both."""
    keep_e, keep_d = exp(-a * dt), exp(-b * dt)
    carried = (keep_d - keep_e) / (a - b)
    power = 2.0 * a * spread * spread
    fast, mixed, slow = _grown(2.0 * a, dt), _grown(a + b, dt), _grown(2.0 * b, dt)
    variance_e = power * fast
    covariance = power * (mixed - fast) / (a - b)
    variance_d = power * (slow - 2.0 * mixed + fast) / (a - b) ** 2
    first = sqrt(variance_e)
    both = covariance / first if first > 0.0 else 0.0
    return keep_e, keep_d, carried, first, both, sqrt(max(0.0, variance_d - both * both))


def _grown(rate: float, t: float) -> float:
    """Return ∫₀ᵗ e^(−rate s) ds."""
    return -expm1(-rate * t) / rate if rate > 0.0 else t
