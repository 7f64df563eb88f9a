"""What force a budget of energy covers, though the motion of the coming tick is not known yet."""

from __future__ import annotations

from math import sqrt

from drivers.device import Vector3

# By no more than this hand or handle accelerate within a tick, m/s² (a force of 10 N on 0.1 kg).
ACCELERATION = 100.0
# A budget is not spent in one tick but over so long, s: else a force would come and go with every bit of energy
# that a hand gives, and buzz.
SPENT_S = 0.1
# Slower than this, m/s, the handle has no direction.
STILL = 1e-9


def affordable(budget: float, speed: float, dt: float) -> float:
    """Return the force along the motion, N, that a budget, J, affords; less than zero repays a debt, at once.

    Args:
        budget: What may be given, J.
        speed: Of the handle, m/s, not zero.
        dt: Of the tick, s.
    """
    return budget / (speed * (max(dt, SPENT_S) if budget > 0.0 else dt))


def lowered(force: Vector3, velocity: Vector3, speed: float, allowed: float) -> Vector3:
    """Return the force, N, with its part along the motion brought down to `allowed`, N, where it is more.

    Args:
        force: N.
        velocity: Of the handle, m/s.
        speed: Its length, not zero.
        allowed: N along the motion; less than zero brakes.
    """
    (x, y, z), (u, v, w) = force, velocity
    along = (x * u + y * v + z * w) / speed
    if along <= allowed:
        return force
    less = (along - allowed) / speed
    return x - less * u, y - less * v, z - less * w


def no_longer(force: Vector3, wanted: Vector3, damping: float) -> Vector3:
    """Return a damped force, N, shortened to the longer of the one wanted and the damping alone, N.

    What is wanted is within the device's limit, so what is rendered is as well.
    """
    (x, y, z), (a, b, c) = force, wanted
    most = max(a * a + b * b + c * c, damping * damping)
    length = x * x + y * y + z * z
    if length <= most:
        return force
    share = sqrt(most / length)
    return x * share, y * share, z * share


def covered(force: Vector3, velocity: Vector3, span: float, budget: float) -> Vector3:
    """Return the force, shortened until it cannot give more than `budget`, J, whatever motion the tick brings.

    From when it was last seen until the next tick the handle moves by v dt, and by at most r = ½ a dt² beside it.
    Then f·Δx ≤ f·v dt + |f| r, which grows with the length of f. A force that brakes for certain needs no budget.

    Args:
        force: N.
        velocity: Of the handle as it was last seen, m/s.
        span: From then until the next tick, s: the dt above.
        budget: What may be given, J.
    """
    (x, y, z), (u, v, w) = force, velocity
    unseen = 0.5 * ACCELERATION * span * span
    most = (x * u + y * v + z * w) * span + sqrt(x * x + y * y + z * z) * unseen
    if most <= 0.0 or most <= budget:
        return force
    share = max(0.0, budget) / most
    return x * share, y * share, z * share
