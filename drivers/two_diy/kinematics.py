"""The five-bar linkage of the 2DIY, version 3: two motors, four links, one handle, all in a plane.

Mechanism frame: origin at motor 1, x toward motor 2, y from the motors to the handle; metres, radians, newtons,
newton metres. Crank i turns its elbow E_i about motor i; two forearms join the elbows to the handle P:

    |P − E_i| = L  ⇒  u_i · dP = u_i · (dE_i/dθ_i) dθ_i,   u_i = P − E_i

which is the Jacobian without differentiating the closed form. Lengths are those of Haply's open hAPI (class
`Pantograph`, version 3).
"""

from __future__ import annotations

import math

CRANK = 0.07
FOREARM = 0.09
BASE = 0.038
"""Length of the cranks and forearms, distance between the motors, m."""

Pair = tuple[float, float]
Matrix2 = tuple[Pair, Pair]

# Below this the forearms are in line and the linkage transmits no force across them, sine of their angle.
SINGULAR = 1e-3


def forward(theta1: float, theta2: float) -> Pair | None:
    """Return where the handle is, m, or None where the arms cannot meet or are folded onto each other."""
    (ax, ay), (bx, by) = _elbows(theta1, theta2)
    hx, hy = bx - ax, by - ay
    gap = math.hypot(hx, hy)
    height2 = FOREARM * FOREARM - 0.25 * gap * gap
    if not (gap > 0.0 and height2 >= 0.0):
        return None
    lift = math.sqrt(height2) / gap
    return ax + 0.5 * hx - lift * hy, ay + 0.5 * hy + lift * hx


def inverse(x: float, y: float) -> Pair | None:
    """Return the motors' angles with the elbows outward, rad, or None where the handle cannot be there."""
    inner1 = _elbow_angle(x, y)
    inner2 = _elbow_angle(x - BASE, y)
    if inner1 is None or inner2 is None:
        return None
    return math.atan2(y, x) + inner1, math.atan2(y, x - BASE) - inner2


def jacobian(theta1: float, theta2: float) -> Matrix2 | None:
    """Return ((∂x/∂θ₁, ∂x/∂θ₂), (∂y/∂θ₁, ∂y/∂θ₂)), m/rad, or None where there is none: a singular pose."""
    place = forward(theta1, theta2)
    if place is None:
        return None
    (ax, ay), (bx, by) = _elbows(theta1, theta2)
    u1x, u1y = place[0] - ax, place[1] - ay
    u2x, u2y = place[0] - bx, place[1] - by
    determinant = u1x * u2y - u1y * u2x
    if abs(determinant) < SINGULAR * FOREARM * FOREARM:
        return None
    # u · dE/dθ, where dE/dθ is the crank turned by a quarter.
    g1 = (u1y * ax - u1x * ay) / determinant
    g2 = (u2y * (bx - BASE) - u2x * by) / determinant
    return (u2y * g1, -u1y * g2), (-u2x * g1, u1x * g2)


def torques(theta1: float, theta2: float, force: Pair) -> Pair:
    """Return τ = Jᵀ F, N·m, for a force on the hand, N; none in a singular pose."""
    matrix = jacobian(theta1, theta2)
    if matrix is None:
        return 0.0, 0.0
    (xx, xy), (yx, yy) = matrix
    fx, fy = force
    return xx * fx + yx * fy, xy * fx + yy * fy


def _elbows(theta1: float, theta2: float) -> Matrix2:
    return (
        (CRANK * math.cos(theta1), CRANK * math.sin(theta1)),
        (BASE + CRANK * math.cos(theta2), CRANK * math.sin(theta2)),
    )


def _elbow_angle(x: float, y: float) -> float | None:
    """Return the angle at a motor between its crank and the line to the handle, by the law of cosines."""
    reach = math.hypot(x, y)
    if reach == 0.0:
        return None
    cosine = (CRANK * CRANK + reach * reach - FOREARM * FOREARM) / (2.0 * CRANK * reach)
    return math.acos(cosine) if -1.0 <= cosine <= 1.0 else None
