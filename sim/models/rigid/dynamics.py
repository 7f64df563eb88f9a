"""The rigid body's equations of motion, for floats, rows and numba alike (see `sim.models.one_source`).

State, a flat tuple of 17: position x, y, z (world, ENU, m), velocity (world, m/s), attitude quaternion w, x, y, z
(body, FLU, to world), body rates p, q, r (rad/s), and the four rotors' speeds as shares of the largest.

Rotors, as PX4 numbers a quadrotor X: 1 front right and 2 rear left turn counter-clockwise seen from above, 3 front
left and 4 rear right clockwise.

    v̇ = (c_T g(z) Σ nᵢ²) e_z − D_h u − (D_v − D_h)(e_z·u) e_z − g ẑ        u = v − wind, e_z the body's up
    q̇ = ½ q ⊗ (0, ω)
    ω̇ = I⁻¹ (τ − ω × I ω)
    ṅᵢ = (n_ref,i − nᵢ) / T_up or T_down

- Rotor drag, linear in the velocity through the air, by body axes: Faessler, Franchi, Scaramuzza, "Differential
  flatness of quadrotor dynamics subject to rotor drag", RA-L 2018, equation (3), with equal drag forward and left.
- Ground effect g(z) = 1 / (1 − (R / 4 h)²), h the rotors' height above the floor: Cheeseman and Bennett, "The effect
  of the ground on a helicopter rotor in forward flight", ARC R&M 3021, 1955. Below h = R/2, where the theory ends, it
  grows no more.
- Rotor speeds are solved exactly over a step, all else by the classical fourth-order Runge-Kutta method, in which
  position, whose rate is the velocity, needs no stages of its own but height.
"""

from __future__ import annotations

from math import sqrt

from sim.models.one_source import clip

State = tuple[
    float, float, float, float, float, float, float, float, float, float, float, float, float, float, float,
    float, float,
]  # fmt: skip
Four = tuple[float, float, float, float]
Three = tuple[float, float, float]
# dt, the share of the way to its reference that a rotor goes in half a step and in a whole one, upward and
# downward, and what nᵢ² accelerates: c_T, m/s², and about forward, left and up, rad/s².
Rotors = tuple[float, float, float, float, float, float, float, float, float]
# (I_yy − I_zz)/I_xx, (I_zz − I_xx)/I_yy, (I_xx − I_yy)/I_zz; D_h and D_v − D_h, 1/s; g, m/s²; (R/4)², m², the
# rotors' height on the ground, m, and the least that counts, m.
Body = tuple[float, float, float, float, float, float, float, float, float]
# Velocity through the air, world, m/s; quaternion; body rates, rad/s. And their rates.
Moving = tuple[float, float, float, float, float, float, float, float, float, float]


def derivative(height: float, moving: Moving, forces: Four, body: Body) -> Moving:
    """Return the rates of change of `moving`.

    Args:
        height: Of the vehicle above the floor, m.
        moving: Velocity through the air, quaternion, body rates.
        forces: What the rotors accelerate free of the ground, along up, m/s², about forward, left, up, rad/s².
        body: Constants.
    """
    ux, uy, uz, w, x, y, z, p, q, r = moving
    thrust, roll, pitch, yaw = forces
    j_p, j_q, j_r, d_h, d_v, g, quarter, mount, least = body
    above = clip(height + mount, least, 1e9)
    square = above * above
    ground = square / (square - quarter)
    zx, zy, zz = 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)
    along = thrust * ground - d_v * (ux * zx + uy * zy + uz * zz)
    a, b, c = 0.5 * p, 0.5 * q, 0.5 * r
    return (
        along * zx - d_h * ux,
        along * zy - d_h * uy,
        along * zz - d_h * uz - g,
        -a * x - b * y - c * z,
        a * w + c * y - b * z,
        b * w - c * x + a * z,
        c * w + b * x - a * y,
        roll * ground + j_p * q * r,
        pitch * ground + j_q * r * p,
        yaw + j_r * p * q,
    )


def pulls(speeds: Four, rotors: Rotors) -> Four:
    """Return what rotors at these speeds accelerate: along up, m/s², and about forward, left, up, rad/s²."""
    n1, n2, n3, n4 = speeds
    _dt, _up_half, _up, _down_half, _down, c_t, c_p, c_q, c_r = rotors
    a, b, c, d = n1 * n1, n2 * n2, n3 * n3, n4 * n4
    return c_t * (a + b + c + d), c_p * (b + c - a - d), c_q * (b + d - a - c), c_r * (c + d - a - b)


def along(moving: Moving, rates: Moving, step: float) -> Moving:
    """Return `moving` after `step` seconds at these rates."""
    ux, uy, uz, w, x, y, z, p, q, r = moving
    ax, ay, az, dw, dx, dy, dz, dp, dq, dr = rates
    return (
        ux + step * ax, uy + step * ay, uz + step * az,
        w + step * dw, x + step * dx, y + step * dy, z + step * dz,
        p + step * dp, q + step * dq, r + step * dr,
    )  # fmt: skip


def turned(speeds: Four, command: Four, up: float, down: float) -> Four:
    """Return the rotors' speeds after the shares `up` and `down` of their ways to the command.

    A command that holds still is never passed, so each rotor keeps its direction over a step: this is exact.
    """
    n1, n2, n3, n4 = speeds
    d1, d2, d3, d4 = command[0] - n1, command[1] - n2, command[2] - n3, command[3] - n4
    u1, u2, u3, u4 = clip(d1, 0.0, 1.0), clip(d2, 0.0, 1.0), clip(d3, 0.0, 1.0), clip(d4, 0.0, 1.0)
    return (
        n1 + up * u1 + down * (d1 - u1),
        n2 + up * u2 + down * (d2 - u2),
        n3 + up * u3 + down * (d3 - u3),
        n4 + up * u4 + down * (d4 - u4),
    )


def advance(state: State, command: Four, wind: Three, rotors: Rotors, body: Body) -> State:
    """Return the state one step later.

    Args:
        state: Now.
        command: Rotor speeds asked for, shares of the largest; 0 stops them.
        wind: The air's velocity, world, m/s.
        rotors: Constants, with the step's length.
        body: Constants.
    """
    px, py, pz, vx, vy, vz, w, x, y, z, p, q, r, n1, n2, n3, n4 = state
    dt, up_half, up, down_half, down, _c_t, _c_p, _c_q, _c_r = rotors
    half, sixth = 0.5 * dt, dt / 6.0
    begin = (n1, n2, n3, n4)
    end = turned(begin, command, up, down)
    middle = pulls(turned(begin, command, up_half, down_half), rotors)
    moving = (vx - wind[0], vy - wind[1], vz - wind[2], w, x, y, z, p, q, r)
    k1 = derivative(pz, moving, pulls(begin, rotors), body)
    k2 = derivative(pz + half * vz, along(moving, k1, half), middle, body)
    k3 = derivative(pz + half * (vz + half * k1[2]), along(moving, k2, half), middle, body)
    k4 = derivative(pz + dt * (vz + half * k2[2]), along(moving, k3, dt), pulls(end, rotors), body)

    ax1, ay1, az1, dw1, dx1, dy1, dz1, dp1, dq1, dr1 = k1
    ax2, ay2, az2, dw2, dx2, dy2, dz2, dp2, dq2, dr2 = along(k2, k3, 1.0)
    ax4, ay4, az4, dw4, dx4, dy4, dz4, dp4, dq4, dr4 = k4
    w, x = w + sixth * (dw1 + 2.0 * dw2 + dw4), x + sixth * (dx1 + 2.0 * dx2 + dx4)
    y, z = y + sixth * (dy1 + 2.0 * dy2 + dy4), z + sixth * (dz1 + 2.0 * dz2 + dz4)
    unit = 1.0 / sqrt(w * w + x * x + y * y + z * z)
    return (
        px + dt * (vx + sixth * (ax1 + ax2)),
        py + dt * (vy + sixth * (ay1 + ay2)),
        pz + dt * (vz + sixth * (az1 + az2)),
        vx + sixth * (ax1 + 2.0 * ax2 + ax4),
        vy + sixth * (ay1 + 2.0 * ay2 + ay4),
        vz + sixth * (az1 + 2.0 * az2 + az4),
        w * unit, x * unit, y * unit, z * unit,
        p + sixth * (dp1 + 2.0 * dp2 + dp4),
        q + sixth * (dq1 + 2.0 * dq2 + dq4),
        r + sixth * (dr1 + 2.0 * dr2 + dr4),
        *end,
    )  # fmt: skip
