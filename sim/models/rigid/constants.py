"""What the rigid body's equations need of an airframe: its physical table, and the constants made of it."""

from __future__ import annotations

from math import acos, cos, exp, radians, sin, sqrt, tan
from typing import Annotated, NamedTuple

from msgspec import Meta, Struct

from sim.models.motion import GRAVITY
from sim.models.rigid.control import Gains
from sim.models.rigid.dynamics import Body, Rotors, State, Three

Mass = Annotated[float, Meta(gt=0, le=100)]
Length = Annotated[float, Meta(gt=0, le=5)]
Inertia = Annotated[float, Meta(gt=0, le=100)]
Lag = Annotated[float, Meta(gt=0, le=0.5)]
Drag = Annotated[float, Meta(ge=0, le=100)]

# The least thrust that lifts, over weight; PX4's MPC_THR_MIN; and what of the thrust is left to hold the attitude.
LEAST_LIFT = 1.2
_THRUST_LEAST, _THRUST_MOST = 0.12, 0.9
# PX4's defaults of MPC_XY_VEL_P_ACC, MPC_Z_VEL_P_ACC, MPC_XY_VEL_I_ACC, MPC_Z_VEL_I_ACC, MC_ROLL_P,
# MC_ROLLRATE_MAX (degrees/s).
_VELOCITY_P, _CLIMB_P, _VELOCITY_I, _CLIMB_I, _TILT_P, _TILT_RATE = 1.8, 4.0, 0.4, 2.0, 6.5, 220.0
# The rate loop: as fast as PX4's on a 250 mm to 500 mm quadrotor, 1/s, if the rotors follow within `_PROMPT`, s; a
# lead makes slower rotors as prompt, up to so many times. Yaw, by reaction torque alone, is slower.
_RATE_P, _PROMPT, _MOST_LEAD, _YAW_SHARE = 25.0, 0.02, 3.0, 1.0 / 3.0
# What measuring may add to the sum of a flat body's other two moments of inertia, as published for the Crazyflie.
_FLAT = 1.02
# Below half a rotor's radius the theory of the ground effect ends.
_GROUND_LEAST = 0.5


class Physique(Struct, frozen=True, forbid_unknown_fields=True):
    """A quadrotor X as a rigid body: the `[body]` table of an airframe.

    Attributes:
        mass: With battery, kg.
        inertia: About forward, left and up, kg m².
        arm: From the centre to a rotor; all four stand at 45° to forward, m.
        rotor_radius: m.
        rotor_height: Of the rotors above the floor when it stands, m.
        rotor_thrust: The most that one rotor gives, N.
        torque_ratio: A rotor's reaction torque over its thrust, m.
        motor_up_s: Time constant of a rotor's speed when it rises, s.
        motor_down_s: When it falls, s.
        drag: At hover, of the velocity across the rotors' axes and along them, N s/m.
    """

    mass: Mass
    inertia: tuple[Inertia, Inertia, Inertia]
    arm: Length
    rotor_radius: Length
    rotor_height: Length
    rotor_thrust: Annotated[float, Meta(gt=0, le=1000)]
    torque_ratio: Annotated[float, Meta(gt=0, le=1)]
    motor_up_s: Lag
    motor_down_s: Lag
    drag: tuple[Drag, Drag]

    @property
    def lift(self) -> float:
        """The most thrust over the weight."""
        return 4.0 * self.rotor_thrust / (self.mass * GRAVITY)


class Limits(NamedTuple):
    """Of the airframe, for its controllers: largest tilt, rad, and yaw rate, rad/s."""

    tilt: float
    yaw_rate: float


def unphysical(body: Physique) -> str | None:
    """Return what no rigid body or no flying one has, as `key: reason`, or None.

    Each moment of inertia is at most the sum of the other two, as for every distribution of mass; a flat body's is as
    large, and a little more where it was measured.
    """
    x, y, z = body.inertia
    if max(x, y, z) > _FLAT * (x + y + z - max(x, y, z)):
        return f"body.inertia: {x}, {y}, {z} is no body's; the largest is at most the sum of the other two."
    if max(x, y, z) > body.mass * (3.0 * body.arm) ** 2:
        return f"body.inertia: {max(x, y, z)} is too large for {body.mass} kg on arms of {body.arm} m."
    if body.lift < LEAST_LIFT:
        return (
            f"body.rotor_thrust: four rotors lift {body.lift:.2f} times the weight; "
            f"to fly takes {LEAST_LIFT} at least."
        )
    return None


def rotors(body: Physique, dt: float) -> Rotors:
    """Return the rotors' constants for steps of `dt` seconds."""
    way = tuple(
        1.0 - exp(-step / lag) for lag in (body.motor_up_s, body.motor_down_s) for step in (0.5 * dt, dt)
    )
    lever, (x, y, z) = body.arm / sqrt(2.0), body.inertia
    thrust = body.rotor_thrust
    return (
        dt,
        *(way[0], way[1], way[2], way[3]),
        *(thrust / body.mass, thrust * lever / x, thrust * lever / y, thrust * body.torque_ratio / z),
    )


def inertias(body: Physique) -> Body:
    """Return the body's constants."""
    (x, y, z), (across, along) = body.inertia, body.drag
    radius, height = body.rotor_radius, body.rotor_height
    return (
        *((y - z) / x, (z - x) / y, (x - y) / z),
        *(across / body.mass, (along - across) / body.mass, GRAVITY),
        *((0.25 * radius) ** 2, height, _GROUND_LEAST * radius),
    )


def gains(body: Physique, limits: Limits, dt: float) -> Gains:
    """Return the controllers' constants for steps of `dt` seconds.

    Torque follows with τ/(1 + lead); the rate loop K/(s (1 + s τ/(1 + lead))) is well damped while K ≤ (1 + lead)/2τ.
    The loops outside are PX4's, slower where this one has to be.
    """
    lag = 0.5 * (body.motor_up_s + body.motor_down_s)
    lead = max(0.0, min(_MOST_LEAD, lag / _PROMPT - 1.0))
    rate = min(_RATE_P, 0.5 * (1.0 + lead) / lag)
    tilt = min(_TILT_P, rate / 3.5)
    velocity, climb = min(_VELOCITY_P, tilt / 3.5), min(_CLIMB_P, 0.3 / lag)
    _, _, _, _, _, c_t, c_p, c_q, c_r = rotors(body, dt)
    strongest = 4.0 * c_t * _THRUST_MOST
    sideways = GRAVITY * tan(min(limits.tilt, acos(min(1.0, GRAVITY / (0.95 * strongest)))))
    boost = 0.25 * rate * (1.0 + lead)
    return (
        *(velocity, climb, _VELOCITY_I * dt * velocity / _VELOCITY_P, _CLIMB_I * dt * climb / _CLIMB_P),
        *(sideways, GRAVITY, sideways, 4.0 * c_t * _THRUST_LEAST - GRAVITY, strongest - GRAVITY),
        *(tilt, radians(_TILT_RATE), limits.yaw_rate),
        *(boost / c_p, boost / c_q, _YAW_SHARE * boost / c_r, 0.25 * lead),
        *(0.25 / (c_t * GRAVITY), _THRUST_LEAST, _THRUST_MOST, 0.5),
    )


def hover(p: tuple[float, float, float, float], rotors: Rotors, body: Body) -> tuple[State, Three]:
    """Return the state that hovers in still air at p = [x, y, z, yaw], and the velocity loop's integral there."""
    x, y, z, yaw = p
    g, quarter, above = body[5], body[6], max(z + body[7], body[8])
    thrust = g * (1.0 - quarter / (above * above))
    speed = sqrt(0.25 * thrust / rotors[5])
    w, up = cos(0.5 * yaw), sin(0.5 * yaw)
    still = (0.0, 0.0, 0.0)
    return (x, y, z, *still, w, 0.0, 0.0, up, *still, speed, speed, speed, speed), (0.0, 0.0, thrust - g)
