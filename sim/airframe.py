"""Airframes: what the simulated vehicle is, read strictly from a preset or a file like it."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from sim.models.dynamic import Chi, Dynamic
from sim.models.kinematic import Kinematic
from sim.models.lean import Lean
from sim.models.motion import Motion
from sim.models.rigid.body import RigidBody
from sim.models.rigid.constants import Limits, Physique
from sim.models.rigid.constants import unphysical as unphysical_body
from sim.scenario import ScenarioError, error_sentence, read_toml

PRESETS_FOLDER = Path(__file__).resolve().parent / "airframes"
SUFFIX = ".toml"

Model = Literal["kinematic", "dynamic", "rigid_body"]
Speed = Annotated[float, Meta(gt=0, le=100)]


class Airframe(Struct, frozen=True, forbid_unknown_fields=True):
    """A kind of vehicle. It flies the models it has the numbers for: `chi`, `body`, or both.

    Attributes:
        schema: Version of this format.
        name: Short, as in the file's name.
        title: One line for people.
        source: Where the numbers come from.
        estimated: Which of them are estimates, and on what ground; "" if none.
        radius: Of the sphere that collides, propellers included, m.
        horizontal_speed: Largest reference forward and left together, m/s; likewise climb and descent.
        yaw_rate_deg: Largest reference about the vertical, degrees/s.
        tilt_deg: Largest roll or pitch, degrees.
        attitude_time: Time constant with which roll and pitch follow the acceleration, s.
        air_drag: D, what a metre per second of wind accelerates, 1/s; see `sim.models.dynamic.Dynamic`.
        endurance_s: Hovering time from a full battery, s.
        cells: Battery cells in series.
        chi: The velocity response, for the dynamic model.
        body: Mass, inertia and rotors, for the rigid body.
    """

    schema: Literal[1]
    name: Annotated[str, Meta(min_length=1, max_length=48)]
    title: Annotated[str, Meta(min_length=1)]
    source: Annotated[str, Meta(min_length=1)]
    radius: Annotated[float, Meta(gt=0, le=10)]
    horizontal_speed: Speed
    climb_speed: Speed
    descent_speed: Speed
    yaw_rate_deg: Annotated[float, Meta(gt=0, le=720)]
    tilt_deg: Annotated[float, Meta(gt=0, lt=80)]
    attitude_time: Annotated[float, Meta(gt=0, le=2)]
    air_drag: Annotated[float, Meta(ge=0, le=10)]
    endurance_s: Annotated[float, Meta(gt=0, le=1e6)]
    cells: Annotated[int, Meta(ge=1, le=24)]
    estimated: str = ""
    chi: Chi | None = None
    body: Physique | None = None

    @property
    def yaw_rate(self) -> float:
        """Largest reference about the vertical, rad/s."""
        return math.radians(self.yaw_rate_deg)

    def models(self) -> tuple[Model, ...]:
        """Return the models that this airframe can fly."""
        has: dict[Model, object] = {"kinematic": True, "dynamic": self.chi, "rigid_body": self.body}
        return tuple(model for model, numbers in has.items() if numbers)


def _kinematic(airframe: Airframe) -> Motion:
    return Kinematic(airframe.air_drag, _lean(airframe))


def _dynamic(airframe: Airframe) -> Motion:
    if airframe.chi is None:
        raise _cannot_fly(airframe, "dynamic", "[chi]")
    return Dynamic(airframe.chi, airframe.air_drag, _lean(airframe))


def _rigid_body(airframe: Airframe) -> Motion:
    if airframe.body is None:
        raise _cannot_fly(airframe, "rigid_body", "[body]")
    return RigidBody(airframe.body, Limits(math.radians(airframe.tilt_deg), airframe.yaw_rate))


# What makes a model; it raises a ScenarioError for an airframe that lacks the numbers.
MODELS: dict[Model, Callable[[Airframe], Motion]] = {
    "kinematic": _kinematic,
    "dynamic": _dynamic,
    "rigid_body": _rigid_body,
}


def _lean(airframe: Airframe) -> Lean:
    return Lean(math.radians(airframe.tilt_deg), airframe.attitude_time, airframe.air_drag)


def _cannot_fly(airframe: Airframe, model: Model, table: str) -> ScenarioError:
    return ScenarioError(
        f"airframe {airframe.name} has no {table} table, so it cannot fly the model {model}; "
        f"choose {' or '.join(airframe.models())}."
    )


def load_airframe(name: str) -> Airframe:
    """Read an airframe by a preset's name, or by the path of a `.toml` file.

    Raises:
        ScenarioError: With file, key and reason in one sentence.
    """
    path = find_airframe(name)
    try:
        airframe = msgspec.convert(read_toml(path), Airframe, strict=True)
    except msgspec.ValidationError as error:
        raise ScenarioError(f"{path}: {error_sentence(error)}") from error
    if unphysical := _unphysical(airframe):
        raise ScenarioError(f"{path}: {unphysical}")
    return airframe


def find_airframe(name: str) -> Path:
    """Return the file of an airframe.

    Raises:
        ScenarioError: There is none; the message lists the presets.
    """
    given = Path(name)
    if given.suffix == SUFFIX:
        return given
    shipped = PRESETS_FOLDER / f"{name}{SUFFIX}"
    if shipped.parent == PRESETS_FOLDER and shipped.is_file():
        return shipped
    known = ", ".join(sorted(path.stem for path in PRESETS_FOLDER.glob(f"*{SUFFIX}")))
    raise ScenarioError(f"{name}: no such airframe; give a .toml file or one of: {known}.")


def _unphysical(airframe: Airframe) -> str | None:
    """Return what no vehicle has, as `key: reason`, or None."""
    if airframe.chi is None and airframe.body is None:
        return "chi, body: both are missing; give one of the two tables at least."
    if airframe.body is not None:
        if airframe.radius < airframe.body.arm:
            return f"radius: {airframe.radius} is less than body.arm; it holds the propellers too."
        if reason := unphysical_body(airframe.body):
            return reason
    return None if airframe.chi is None else _unphysical_chi(airframe.chi, airframe.yaw_rate)


def _unphysical_chi(chi: Chi, yaw_rate: float) -> str | None:
    """Return what makes the response impossible or unstable, as `key: reason`, or None.

    M and the damping must be positive; while turning at ω, forward and left stay stable only if the determinant
    of C(ω) is positive too (its trace is): χ₁₀ χ₁₄ − ω² χ₁₁ χ₁₃ > 0.
    """
    for key in ("chi_1", "chi_3", "chi_5", "chi_9", "chi_10", "chi_14", "chi_16", "chi_19"):
        if getattr(chi, key) <= 0.0:
            return f"chi.{key}: {getattr(chi, key)} is not physical; inertia and damping are above 0."
    if chi.chi_10 * chi.chi_14 <= yaw_rate**2 * chi.chi_11 * chi.chi_13:
        return "chi.chi_11, chi.chi_13: unstable while turning at yaw_rate_deg; lower one of the three."
    return None
