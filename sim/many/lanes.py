"""What each model makes of one vehicle of a batch: a lane, a flat tuple of all that the vehicle is.

The functions on lanes are one source for floats, rows and numba, see `sim.models.one_source`. A lane of the kinematic
or the dynamic model is `p` and `v`; the lean, which only follows, is left out. A rigid body's is its state and its
velocity loop's integral.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, radians, sin
from typing import Any, NamedTuple

from msgspec.structs import astuple

from sim.airframe import MODELS, Airframe, Model
from sim.kinematics import ZERO3, ZERO4, Vector3, Vector4, advance, world_rates, wrap
from sim.models.dynamic import along, carried, rate, respond
from sim.models.falling import Decay, decay, fall
from sim.models.one_source import clip
from sim.models.rigid.constants import Limits, gains, inertias, rotors
from sim.models.rigid.constants import hover as hovering
from sim.models.rigid.control import Gains, control
from sim.models.rigid.dynamics import Body, Rotors, State, derivative, pulls, turned
from sim.models.rigid.dynamics import advance as advance_rigid
from sim.models.rigid.dynamics import along as along_rigid
from sim.models.rigid.posture import shadow, taken

Light = tuple[*Vector4, *Vector4]
Rigid = tuple[*State, *Vector3]
# D, 1/s, and the fall's constants, the step's length first among them; then χ.
KinematicConstants = tuple[float, *Decay]
DynamicConstants = tuple[
    float, *Decay, float, float, float, float, float, float, float, float, float, float
]  # fmt: skip
RigidConstants = tuple[*Gains, *Rotors, *Body]
Flat = tuple[float, ...]


class Law(NamedTuple):
    """A model on lanes.

    Attributes:
        name: Its own.
        width: Numbers in a lane.
        functions: The one-source functions it is made of, callees before their callers.
        flown: (lane, v_ref, wind, constants) → the lane one step later.
        fallen: The same with the motors stopped.
        seen: lane → p, v.
        resting: p → the lane of a vehicle that stands level at p, motors still.
        placed: (lane, its p, its v, p, v) → the lane of a vehicle put to p, as fast as v.
        constants: (airframe, dt) → the constants, a flat tuple.
        hover: (p, airframe) → the lane of a vehicle that hovers at p in still air.
    """

    name: str
    width: int
    functions: tuple[Callable[..., object], ...]
    flown: Callable[..., Any]
    fallen: Callable[..., Any]
    seen: Callable[..., tuple[Vector4, Vector4]]
    resting: Callable[..., Any]
    placed: Callable[..., Any]
    constants: Callable[[Airframe, float], Flat]
    hover: Callable[[Vector4, Airframe], Flat]


def law(airframe: Airframe, model: Model) -> Law:
    """Return a model's law.

    Raises:
        ScenarioError: The airframe lacks the model's numbers.
    """
    MODELS[model](airframe)
    return _LAWS[model]


def kinematic_flown(lane: Light, v_ref: Vector4, _wind: Vector3, constants: KinematicConstants) -> Light:
    """Step a kinematic vehicle."""
    return advance(lane[:4], v_ref, constants[1]) + v_ref


def kinematic_fallen(lane: Light, _v_ref: Vector4, wind: Vector3, constants: KinematicConstants) -> Light:
    """Step a kinematic vehicle whose motors have stopped."""
    p, v = fall(lane[:4], lane[4:], wind, constants[0], constants[1:])
    return p + v


def dynamic_flown(lane: Light, v_ref: Vector4, wind: Vector3, constants: DynamicConstants) -> Light:
    """Step a vehicle of the dynamic model."""
    p, v = respond(lane[:4], lane[4:], v_ref, wind, (constants[5:], constants[0], constants[1]))
    return p + v


def dynamic_fallen(lane: Light, _v_ref: Vector4, wind: Vector3, constants: DynamicConstants) -> Light:
    """Step a vehicle of the dynamic model whose motors have stopped."""
    p, v = fall(lane[:4], lane[4:], wind, constants[0], constants[1:5])
    return p + v


def light_seen(lane: Light) -> tuple[Vector4, Vector4]:
    """Return p and v."""
    return lane[:4], lane[4:]


def light_resting(p: Vector4) -> Light:
    """Return the lane of a vehicle at rest."""
    return p + ZERO4


def light_placed(_lane: Light, _from_p: Vector4, _from_v: Vector4, p: Vector4, v: Vector4) -> Light:
    """Return the lane of a vehicle at p with v."""
    return p + v


def rigid_flown(lane: Rigid, v_ref: Vector4, wind: Vector3, constants: RigidConstants) -> Rigid:
    """Step a rigid body."""
    command, integral = control(lane[:17], lane[17:], v_ref, constants[:20])
    return advance_rigid(lane[:17], command, wind, constants[20:29], constants[29:]) + integral


def rigid_fallen(lane: Rigid, _v_ref: Vector4, wind: Vector3, constants: RigidConstants) -> Rigid:
    """Step a rigid body whose motors are told to stop."""
    return advance_rigid(lane[:17], ZERO4, wind, constants[20:29], constants[29:]) + ZERO3


def rigid_seen(lane: Rigid) -> tuple[Vector4, Vector4]:
    """Return p and v."""
    return shadow(lane[:17])


def rigid_resting(p: Vector4) -> Rigid:
    """Return the lane of a rigid body at rest."""
    half = 0.5 * p[3]
    level = (cos(half), 0.0, 0.0, sin(half))
    return p[:3] + ZERO3 + level + ZERO3 + ZERO4 + ZERO3


def rigid_placed(lane: Rigid, from_p: Vector4, from_v: Vector4, p: Vector4, v: Vector4) -> Rigid:
    """Return the lane of a rigid body put to p, as fast as v; see `sim.models.rigid.posture.taken`."""
    return taken(lane[:17], p, v, wrap(p[3] - from_p[3]), v[3] - from_v[3]) + lane[17:]


def _fall_constants(airframe: Airframe, dt: float) -> KinematicConstants:
    return (airframe.air_drag, *decay(airframe.air_drag, dt))


def _dynamic_constants(airframe: Airframe, dt: float) -> Flat:
    assert airframe.chi is not None
    return (*_fall_constants(airframe, dt), *astuple(airframe.chi))


def _rigid_constants(airframe: Airframe, dt: float) -> RigidConstants:
    body = airframe.body
    assert body is not None
    limits = Limits(radians(airframe.tilt_deg), airframe.yaw_rate)
    return (*gains(body, limits, dt), *rotors(body, dt), *inertias(body))


def _light_hover(p: Vector4, _airframe: Airframe) -> Flat:
    return light_resting(p)


def _rigid_hover(p: Vector4, airframe: Airframe) -> Flat:
    assert airframe.body is not None
    # To hover does not depend on the step; of the rotors' constants it takes their strength.
    state, integral = hovering(p, rotors(airframe.body, 1.0), inertias(airframe.body))
    return state + integral


_LAWS: dict[Model, Law] = {
    "kinematic": Law(
        "kinematic", 8,
        (
            world_rates, advance, fall, kinematic_flown, kinematic_fallen, light_seen, light_resting, light_placed,
        ),
        kinematic_flown, kinematic_fallen, light_seen, light_resting, light_placed,
        _fall_constants, _light_hover,
    ),
    "dynamic": Law(
        "dynamic", 8,
        (
            rate, along, carried, respond, fall, dynamic_flown, dynamic_fallen, light_seen, light_resting,
            light_placed,
        ),
        dynamic_flown, dynamic_fallen, light_seen, light_resting, light_placed,
        _dynamic_constants, _light_hover,
    ),
    "rigid_body": Law(
        "rigid", 20,
        (
            clip, derivative, pulls, along_rigid, turned, advance_rigid, control,
            shadow, wrap, taken, rigid_flown, rigid_fallen, rigid_seen, rigid_resting, rigid_placed,
        ),
        rigid_flown, rigid_fallen, rigid_seen, rigid_resting, rigid_placed,
        _rigid_constants, _rigid_hover,
    ),
}  # fmt: skip
