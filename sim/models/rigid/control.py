"""The rigid body's controllers, for floats, rows and numba alike (see `sim.models.one_source`).

PX4's cascade (PX4 user guide, "Controller Diagrams": Multicopter), with a yaw rate for a yaw:

1. Velocity: PI within limits of horizontal acceleration (which are limits of tilt) and of climb and sink, at which
   the integral waits.
2. Attitude: the tilt's error as a quaternion, times a gain, gives roll and pitch rates; the heading has no error,
   for only its rate is asked for. This is the reduced attitude control of Brescianini, Hehn, D'Andrea, "Nonlinear
   quadrocopter attitude control", ETH Zürich 2013, that PX4 follows. Thrust is what the wanted force has along the
   body's up: Lee, Leok, McClamroch, "Geometric tracking control of a quadrotor UAV on SE(3)", CDC 2010.
3. Rate: P on the body rates, with a lead that makes the rotors' torque follow faster than the rotors' own lag.
4. Mixer: roll and pitch come first, then thrust, then yaw, as in PX4's sequential desaturation with airmode.
"""

from __future__ import annotations

from math import sqrt

from sim.models.one_source import clip
from sim.models.rigid.dynamics import Four, State, Three

# See `sim.models.rigid.constants.gains`, which makes them.
Gains = tuple[
    float, float, float, float, float, float, float, float, float, float, float, float, float, float, float,
    float, float, float, float, float,
]  # fmt: skip


def control(state: State, integral: Three, v_ref: Four, gains: Gains) -> tuple[Four, Three]:
    """Return the rotor speeds to ask for, shares of the largest, and the velocity loop's integral one step later.

    Args:
        state: See `sim.models.rigid.dynamics`.
        integral: Of the velocity loop, world, m/s².
        v_ref: Forward, left, up, m/s, and yaw rate, rad/s, on the heading's axes.
        gains: Constants, with the step's length in them.
    """
    _px, _py, _pz, vx, vy, vz, w, x, y, z, p, q, r, n1, n2, n3, n4 = state
    ix, iy, iz = integral
    (
        kp_h, kp_v, ki_h, ki_v, most_i, g, a_h, a_down, a_up, k_tilt, tilt_rate, yaw_rate,
        k_p, k_q, k_r, lead, per_g, least, most, share,
    ) = gains  # fmt: skip
    # The body's axes in the world: forward, left, up.
    xx, xy, xz = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)
    yx, yy, yz = 2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)
    zx, zy, zz = 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)

    level = 1.0 / sqrt(clip(xx * xx + xy * xy, 1e-12, 2.0))
    c, s = xx * level, xy * level
    ex, ey, ez = c * v_ref[0] - s * v_ref[1] - vx, s * v_ref[0] + c * v_ref[1] - vy, v_ref[2] - vz
    ax, ay, az = kp_h * ex + ix, kp_h * ey + iy, kp_v * ez + iz
    size = sqrt(ax * ax + ay * ay)
    inside = a_h / clip(size, a_h, 1e9)
    bx, by, bz = ax * inside, ay * inside, clip(az, a_down, a_up)
    # The integral waits while what is asked for is beyond the limit: all of it from 1 m/s² beyond on.
    wait = ki_h * clip(1.0 + a_h - size, 0.0, 1.0)
    ix = clip(ix + wait * ex, -most_i, most_i)
    iy = clip(iy + wait * ey, -most_i, most_i)
    iz = clip(iz + ki_v * clip(1.0 - abs(az - bz), 0.0, 1.0) * ez, -most_i, most_i)

    # The wanted thrust points along (bx, by, g); t is that direction on the body's axes.
    length = sqrt(bx * bx + by * by + g * g)
    unit = 1.0 / length
    tx = unit * (bx * xx + by * xy + g * xz)
    ty = unit * (bx * yx + by * yy + g * yz)
    tz = unit * (bx * zx + by * zy + g * zz)
    # Rates 2 k sin(α/2) about the axis up × t, whose length is sin α = 2 sin(α/2) cos(α/2).
    turn = k_tilt / sqrt(clip(0.5 + 0.5 * tz, 1e-6, 1.0))
    heading = clip(v_ref[3], -yaw_rate, yaw_rate)
    p_ref = clip(-ty * turn, -tilt_rate, tilt_rate) + heading * xz
    q_ref = clip(tx * turn, -tilt_rate, tilt_rate) + heading * yz
    r_ref = heading * zz

    s1, s2, s3, s4 = n1 * n1, n2 * n2, n3 * n3, n4 * n4
    roll = k_p * (p_ref - p) - lead * (s2 + s3 - s1 - s4)
    pitch = k_q * (q_ref - q) - lead * (s2 + s4 - s1 - s3)
    yaw = k_r * (r_ref - r) - lead * (s3 + s4 - s1 - s2)
    inside = share / clip(abs(roll) + abs(pitch), share, 1e9)
    roll, pitch = roll * inside, pitch * inside
    # Limits never cross, not even by rounding: there floats and rows would choose differently.
    tilting = clip(abs(roll) + abs(pitch), 0.0, share)
    thrust = clip(clip(per_g * (g + bz) * tz * length, least, most), tilting, 1.0 - tilting)
    room = clip(clip(1.0 - thrust - tilting, 0.0, 1.0), 0.0, thrust - tilting)
    yaw = clip(yaw, -room, room)
    return (
        sqrt(clip(thrust - roll - pitch - yaw, 0.0, 1.0)),
        sqrt(clip(thrust + roll + pitch - yaw, 0.0, 1.0)),
        sqrt(clip(thrust + roll - pitch + yaw, 0.0, 1.0)),
        sqrt(clip(thrust - roll + pitch + yaw, 0.0, 1.0)),
    ), (ix, iy, iz)
