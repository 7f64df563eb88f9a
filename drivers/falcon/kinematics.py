"""The Falcon's geometry: between where the grip is and how the legs stand.

In the plane of leg i, turned by φ_i about z, the grip is at

    u = −r + x cos φ + y sin φ      v = −s − x sin φ + y cos φ      w = z

and the rigid parallelogram between it and the end of the motor's arm, at angle θ, asks that

    G(x, y, z; θ) = ½ ((u + c − a cos θ)² + (w − a sin θ)² − S²) = 0,   S = √(b² − (v + f)²) + d + e.

Everything here comes from G: its root in θ is the inverse kinematics, in closed form; its derivatives give
∂θ/∂x = −G_x/G_θ exactly; Newton's method on the three legs' G is the forward kinematics. Names and lengths are
those of libnifalcon's `FalconGeometry.h`, after Stamper 1997, A three degree of freedom parallel manipulator with
only translational degrees of freedom (PhD thesis, University of Maryland).

Frame: the device's own. x to the right as the operator sees it, y up, z toward the operator; metres, radians.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from drivers.device import Vector3

A, B, C, D, E, F, R, S = 0.060, 0.1025, 0.01443, 0.01125, 0.01125, -0.025, 0.040, -0.02309
_LEGS = tuple((math.cos(phi), math.sin(phi)) for phi in map(math.radians, (105.0, -15.0, -135.0)))
CENTRE: Vector3 = (0.0, 0.0, 0.125)
"""The middle of where the grip can be: it travels from z = 75 to 175 mm."""

REACH = 0.07
"""The grip is never farther from the centre than this, m."""

_STEP = 1e-6
_MOST_STEPS = 12

Rows = tuple[Vector3, Vector3, Vector3]


class Pose(NamedTuple):
    """Where the grip is, and how it moves with the legs.

    Attributes:
        position: m.
        columns: ∂position/∂θ_i of each leg, m/rad: the velocity is their sum weighted with the legs' rates,
            and a force f on the hand takes the torque columns[i]·f, N·m, of leg i.
    """

    position: Vector3
    columns: Rows


class _Constraint(NamedTuple):
    """G of one leg with its derivatives."""

    g: float
    x: float
    y: float
    z: float
    theta: float


def angles(position: Vector3) -> Vector3:
    """Return the legs' angles, rad, at a position, m: the inverse kinematics.

    Raises:
        ValueError: The position is out of reach.
    """
    x, y, z = position
    found: list[float] = []
    for cos_phi, sin_phi in _LEGS:
        u = x * cos_phi + y * sin_phi - R
        v = y * cos_phi - x * sin_phi - S
        s = math.sqrt(B * B - (v + F) ** 2) + D + E
        # a ((u + c) cos θ + w sin θ) = ½ ((u + c)² + w² + a² − S²)
        near = math.hypot(u + C, z)
        found.append(math.atan2(z, u + C) - math.acos((near * near + A * A - s * s) / (2.0 * A * near)))
    return found[0], found[1], found[2]


def slopes(position: Vector3) -> Rows:
    """Return ∂θ_i/∂position of each leg, rad/m: the inverse kinematics differentiated.

    Raises:
        ValueError: The position is out of reach.
    """
    rows: list[Vector3] = []
    for leg, theta in enumerate(angles(position)):
        g = _constraint(leg, position, math.cos(theta), math.sin(theta))
        rows.append((-g.x / g.theta, -g.y / g.theta, -g.z / g.theta))
    return rows[0], rows[1], rows[2]


def locate(legs: Vector3, start: Vector3 = CENTRE) -> Pose | None:
    """Return where the grip is: the forward kinematics, exact to better than 1 nm.

    Args:
        legs: Angles, rad.
        start: A position nearby, m, as the last one.

    Returns:
        The pose, or None where the legs cannot stand so.
    """
    (c1, s1), (c2, s2), (c3, s3) = ((math.cos(theta), math.sin(theta)) for theta in legs)
    position = start
    try:
        for _ in range(_MOST_STEPS):
            one = _constraint(0, position, c1, s1)
            two = _constraint(1, position, c2, s2)
            three = _constraint(2, position, c3, s3)
            pose, moved = _newton(position, one, two, three)
            position = pose.position
            if moved < _STEP:
                return pose if _possible(position, one, two, three) else None
    except (ValueError, ZeroDivisionError):
        # A leg would have to be longer than it is.
        return None
    return None


def torques(pose: Pose, force: Vector3) -> Vector3:
    """Return the torques of the legs, N·m, that press on the hand with a force, N: ∂position/∂θᵀ f."""
    fx, fy, fz = force
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = pose.columns
    return ax * fx + ay * fy + az * fz, bx * fx + by * fy + bz * fz, cx * fx + cy * fy + cz * fz


def combine(rows: Rows, weights: Vector3) -> Vector3:
    """Return Σ weights_i rows_i: a velocity from a pose's columns, a force from the slopes."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = rows
    a, b, c = weights
    return a * ax + b * bx + c * cx, a * ay + b * by + c * cy, a * az + b * bz + c * cz


def _constraint(leg: int, position: Vector3, cos: float, sin: float) -> _Constraint:
    x, y, z = position
    cos_phi, sin_phi = _LEGS[leg]
    du = x * cos_phi + y * sin_phi - R + C - A * cos
    side = y * cos_phi - x * sin_phi - S + F
    dw = z - A * sin
    root = math.sqrt(B * B - side * side)
    s = root + D + E
    dv = s * side / root
    return _Constraint(
        0.5 * (du * du + dw * dw - s * s),
        du * cos_phi - dv * sin_phi,
        du * sin_phi + dv * cos_phi,
        dw,
        A * (du * sin - dw * cos),
    )


def _newton(position: Vector3, one: _Constraint, two: _Constraint, three: _Constraint) -> tuple[Pose, float]:
    """Return the pose after one step, and the step's length, m."""
    x, y, z = position
    g1, x1, y1, z1, t1 = one
    g2, x2, y2, z2, t2 = two
    g3, x3, y3, z3, t3 = three
    # The inverse of the matrix of rows (x_i, y_i, z_i) has the columns row_j × row_k / det.
    ax, ay, az = y2 * z3 - z2 * y3, z2 * x3 - x2 * z3, x2 * y3 - y2 * x3
    bx, by, bz = y3 * z1 - z3 * y1, z3 * x1 - x3 * z1, x3 * y1 - y3 * x1
    cx, cy, cz = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    inverse = -1.0 / (x1 * ax + y1 * ay + z1 * az)
    dx = (g1 * ax + g2 * bx + g3 * cx) * inverse
    dy = (g1 * ay + g2 * by + g3 * cy) * inverse
    dz = (g1 * az + g2 * bz + g3 * cz) * inverse
    t1, t2, t3 = t1 * inverse, t2 * inverse, t3 * inverse
    columns = ((t1 * ax, t1 * ay, t1 * az), (t2 * bx, t2 * by, t2 * bz), (t3 * cx, t3 * cy, t3 * cz))
    return Pose((x + dx, y + dy, z + dz), columns), math.hypot(dx, dy, dz)


def _possible(position: Vector3, one: _Constraint, two: _Constraint, three: _Constraint) -> bool:
    """Say whether this is the way the Falcon is assembled, knees outward, and within reach."""
    outward = one.theta < 0.0 and two.theta < 0.0 and three.theta < 0.0
    return outward and math.dist(position, CENTRE) <= REACH
