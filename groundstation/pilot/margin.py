"""How much gain the position loop bears: the phase margin of a gain, and the largest gain for a margin.

From p̃ to p the loop is K₁, the way there and back, the vehicle's response, and an integrator:

    L(s) = k g e^(−d s) / (s (1 + τ s))

with k a gain of K₁ (tanh has slope 1 at rest, and less beyond), d the total delay, g and τ the response's gain at
rest and time constant. At the crossover ω, |L| = 1, the phase margin is π/2 − ω d − atan(ω τ); without a lag that
is the rule k d < π/2 less the margin.
"""

from __future__ import annotations

from math import atan, hypot, inf, pi, sqrt
from typing import NamedTuple

from groundstation.frames import Vector4
from sim.models.dynamic import Chi

_STEPS = 40


class Lag(NamedTuple):
    """A first-order velocity response: gain at rest, and time constant, s."""

    gain: float
    time: float


Lags = tuple[Lag, Lag, Lag, Lag]

# A vehicle with a velocity controller of its own, where its response is not known: PX4 by its defaults. The time is
# that of the velocity loop, 1 / MPC_XY_VEL_P_ACC (1.8) and 1 / MPC_Z_VEL_P_ACC (4.0), and 0.1 s of the attitude's
# below it; of yaw an estimate.
_PLANE, _UP, _YAW = Lag(1.0, 0.65), Lag(1.0, 0.35), Lag(1.0, 0.25)
USUAL_LAGS: Lags = (_PLANE, _PLANE, _UP, _YAW)
# What compensation makes of a known response: it follows.
COMPENSATED: Lags = (Lag(1.0, 0.05), Lag(1.0, 0.05), Lag(1.0, 0.05), Lag(1.0, 0.05))


def lags_of(chi: Chi) -> Lags:
    """Return the response on each axis of the vehicle as v_ref = M v̇ + C v has it at no yaw rate."""
    return (
        Lag(1.0 / chi.chi_10, chi.chi_1 / chi.chi_10),
        Lag(1.0 / chi.chi_14, chi.chi_3 / chi.chi_14),
        Lag(1.0 / chi.chi_16, chi.chi_5 / chi.chi_16),
        Lag(1.0 / chi.chi_19, chi.chi_9 / chi.chi_19),
    )


def phase_margin(gain: float, delay: float, lag: Lag) -> float:
    """Return the phase margin, rad; negative: unstable.

    Args:
        gain: k, 1/s.
        delay: d, s.
        lag: The response.
    """
    # ω² (1 + τ² ω²) = (k g)², a quadratic in ω².
    size, square = gain * lag.gain, lag.time * lag.time
    wide = 1.0 + sqrt(1.0 + 4.0 * square * size * size)
    crossover = size * sqrt(2.0 / wide)
    return 0.5 * pi - crossover * delay - atan(crossover * lag.time)


def largest_gain(margin: float, delay: float, lag: Lag) -> float:
    """Return the largest k, 1/s, that leaves a phase margin, rad; infinite where neither delay nor lag takes any."""
    left = 0.5 * pi - margin
    if delay <= 0.0 and lag.time <= 0.0:
        return inf
    low, high = 0.0, left / max(delay + lag.time / (1.0 + left * left), 1e-9)
    while high * delay + atan(high * lag.time) < left:
        high *= 2.0
        if high > 1e6:
            return inf
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        if middle * delay + atan(middle * lag.time) < left:
            low = middle
        else:
            high = middle
    return low * hypot(1.0, low * lag.time) / lag.gain


class Loop(NamedTuple):
    """Gains that a delay leaves.

    Attributes:
        delay: That they are for, s.
        k1: Diagonal of K₁ in effect, 1/s.
        k3: Diagonal of the compensation's K₃ in effect, 1/s.
        margin: Least phase margin of the position loop's axes, rad.
    """

    delay: float
    k1: Vector4
    k3: Vector4
    margin: float


def loop_for(delay: float, k1: Vector4, k3: Vector4, margin: float, lags: Lags) -> Loop:
    """Return the gains as set, or less where the delay does not leave the phase margin.

    In the plane K₁ acts on the world's axes and the response on the vehicle's, so both take the slower one's bound.

    Args:
        delay: Total, s.
        k1: Diagonal of K₁ as set, 1/s.
        k3: Diagonal of K₃ as set, 1/s.
        margin: Wanted, rad.
        lags: The response, forward, left, up, yaw.
    """
    bounds = [largest_gain(margin, delay, lag) for lag in lags]
    plane = min(bounds[0], bounds[1])
    used: Vector4 = (min(k1[0], plane), min(k1[1], plane), min(k1[2], bounds[2]), min(k1[3], bounds[3]))
    velocity = largest_gain(margin, delay, Lag(1.0, 0.0))
    least = min(phase_margin(max(used[0], used[1]), delay, lag) for lag in lags[:2])
    least = min(least, phase_margin(used[2], delay, lags[2]), phase_margin(used[3], delay, lags[3]))
    a, b, c, e = k3
    return Loop(delay, used, (min(a, velocity), min(b, velocity), min(c, velocity), min(e, velocity)), least)
