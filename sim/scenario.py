"""The part of a mission file that the simulated world is made of: obstacles, wind, vehicle.

World frame ENU, origin on the ground where the vehicle starts; metres, seconds; degrees only where a name
says so. `groundstation.training.mission` reads the same tables strictly, with those that are not of the simulator.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

Positive = Annotated[float, Meta(gt=0, le=10_000)]
NonNegative = Annotated[float, Meta(ge=0, le=10_000)]
Coordinate = Annotated[float, Meta(ge=-10_000, le=10_000)]
Point = tuple[Coordinate, Coordinate, Coordinate]
Size = tuple[Positive, Positive, Positive]
Name = Annotated[str, Meta(min_length=1, max_length=48, pattern=r"^[\w .\-]+$")]
WindSpeed = Annotated[float, Meta(ge=-40, le=40)]
Air = tuple[WindSpeed, WindSpeed, WindSpeed]


class ScenarioError(Exception):
    """A mission file is wrong; the message names file, key and reason."""


class Box(Struct, frozen=True, forbid_unknown_fields=True, tag_field="shape", tag="box"):
    """A box, turned about the vertical.

    Attributes:
        name: Shown on the map and in collision messages.
        center: m.
        size: Full lengths along its own x, y, z, m.
        yaw_deg: Counter-clockwise from east, degrees.
    """

    name: Name
    center: Point
    size: Size
    yaw_deg: Coordinate = 0.0


class Cylinder(Struct, frozen=True, forbid_unknown_fields=True, tag_field="shape", tag="cylinder"):
    """An upright cylinder: `center` of its volume, `radius`, full `height`, m."""

    name: Name
    center: Point
    radius: Positive
    height: Positive


class Sphere(Struct, frozen=True, forbid_unknown_fields=True, tag_field="shape", tag="sphere"):
    """A sphere: `center` and `radius`, m."""

    name: Name
    center: Point
    radius: Positive


class Wall(
    Struct,
    frozen=True,
    forbid_unknown_fields=True,
    tag_field="shape",
    tag="wall",
    rename={"start": "from", "end": "to"},
):
    """A straight wall that stands on the ground.

    Attributes:
        name: Shown on the map and in collision messages.
        start, end: `from` and `to` in the file: the ends of its middle line, x and y, m.
        height: m.
        thickness: m.
    """

    name: Name
    start: tuple[Coordinate, Coordinate]
    end: tuple[Coordinate, Coordinate]
    height: Positive
    thickness: Positive = 0.1

    def __post_init__(self) -> None:
        if self.start == self.end:
            raise ValueError("from and to are the same point; a wall has a length")


class Gate(Struct, frozen=True, forbid_unknown_fields=True, tag_field="shape", tag="gate"):
    """A frame around an opening to fly through.

    Attributes:
        name: Shown on the map and in collision messages.
        center: Of the opening, m.
        width, height: Of the opening, m.
        yaw_deg: The way through it, counter-clockwise from east.
        frame: Thickness of the frame, in depth too, m.
        sill: It has a beam under the opening; without it the posts stand on the ground.
    """

    name: Name
    center: Point
    width: Positive
    height: Positive
    yaw_deg: Coordinate = 0.0
    frame: Positive = 0.1
    sill: bool = True

    def __post_init__(self) -> None:
        if self.center[2] < 0.5 * self.height:
            raise ValueError("the opening reaches below the ground; raise center or lower height")


Primitive = Box | Cylinder | Sphere
Obstacle = Primitive | Wall | Gate


class Pad(Struct, frozen=True, forbid_unknown_fields=True):
    """A place to land on, drawn but not solid: `position` of its middle, `radius`, m."""

    name: Name
    position: Point
    radius: Positive = 0.5


class Contact(Struct, frozen=True, forbid_unknown_fields=True):
    """What a collision with an obstacle does.

    Attributes:
        restitution: Share of the speed into a surface that comes back, 0 (stops) to 1. The default is an estimate:
            a rotor guard and a hull give a little.
        crash_speed: Hit harder than this, m/s, the motors stop. The default is a drop from half a metre.
    """

    restitution: Annotated[float, Meta(ge=0, le=1)] = 0.2
    crash_speed: Positive = 3.0


class Gust(Struct, frozen=True, forbid_unknown_fields=True):
    """A discrete gust of 1-cosine shape added to the mean wind.

    Attributes:
        start_s: When it begins, s after take-off.
        duration_s: From calm to calm, s.
        velocity: Wind at its peak, m/s, ENU.
    """

    start_s: NonNegative
    duration_s: Positive
    velocity: Air


class Turbulence(Struct, frozen=True, forbid_unknown_fields=True):
    """Continuous turbulence of MIL-F-8785C (MIL-HDBK-1797), low altitude; see `sim.environment.turbulence`.

    Attributes:
        model: Shape of the spectrum.
        intensity: Standard deviation of the vertical gusts, m/s: a tenth of the wind 6 m (20 ft) above the ground.
            The standard's light, moderate and severe are 0.8, 1.5 and 2.3.
    """

    model: Literal["dryden", "von_karman"] = "dryden"
    intensity: Annotated[float, Meta(ge=0, le=10)] = 0.8


class Wind(Struct, frozen=True, forbid_unknown_fields=True):
    """Wind: a constant part, m/s ENU (where the air goes to), gusts, and turbulence."""

    mean: Air = (0.0, 0.0, 0.0)
    gust: tuple[Gust, ...] = ()
    turbulence: Turbulence = Turbulence(intensity=0.0)


class Charge(Struct, frozen=True, forbid_unknown_fields=True):
    """The battery at the start: what `remaining` of it, 0 to 1, and how many times as fast it is drained."""

    remaining: Annotated[float, Meta(gt=0, le=1)] = 1.0
    drain: Annotated[float, Meta(ge=0, le=1000)] = 1.0


class EstimateChoice(Struct, frozen=True, forbid_unknown_fields=True):
    """How well the vehicle knows where it is: one of the qualities in `sim.estimator`."""

    quality: Literal["ideal", "rtk", "gps"] = "ideal"


class VehicleChoice(Struct, frozen=True, forbid_unknown_fields=True):
    """Which simulated vehicle flies the mission; a real one ignores it.

    Attributes:
        airframe: Name of a preset in `sim/airframes/`, or a path to a file like them.
        model: `kinematic` (equations 1-3, ideal), `dynamic` (velocity response χ) or `rigid_body` (six degrees of
            freedom with its own controllers).
        yaw_deg: Heading on the pad, counter-clockwise from east.
    """

    airframe: str = "matrice_100"
    model: Literal["kinematic", "dynamic", "rigid_body"] = "dynamic"
    yaw_deg: Coordinate = 0.0


class Scenario(Struct, frozen=True):
    """All that the simulator needs of a mission. Tables that are not its business are passed over here."""

    vehicle: VehicleChoice = VehicleChoice()
    wind: Wind = Wind()
    obstacle: tuple[Obstacle, ...] = ()
    pad: tuple[Pad, ...] = ()
    contact: Contact = Contact()
    battery: Charge = Charge()
    estimate: EstimateChoice = EstimateChoice()


# Where no mission says otherwise: an empty world, and a vehicle that knows where it is as well as most do.
_BEYOND = 1 << 63
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
STAND_ALONE = Scenario(estimate=EstimateChoice("gps"))


def read_toml(path: Path) -> dict[str, object]:
    """Read a mission file into plain tables.

    Raises:
        ScenarioError: The file cannot be read, is not UTF-8 TOML, or holds a number that is not finite.
    """
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read ({error.strerror}); check the path.") from error
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 text; missions are TOML files.") from error
    except (ValueError, RecursionError) as error:
        # Not only what tomllib calls invalid: a number of thousands of digits is a ValueError.
        raise ScenarioError(f"{path}: is not valid TOML: {error}.") from error
    if why := unusable(tables):
        raise ScenarioError(f"{path}: {why}.")
    return tables


def unusable(tables: dict[str, object]) -> str:
    """Return what keeps nested tables from being used at all, in words, or ""."""
    try:
        if where := not_finite(tables):
            return f"{where}: is not a finite number; give a plain number"
        if where := not_printable(tables):
            return f"{where}: has a control character, which a terminal would obey; take it out"
    except RecursionError:
        return "its tables are nested too deep"
    return ""


def not_printable(value: object, key: str = "") -> str | None:
    """Return the dotted key of the first text in nested tables with a character that moves a cursor, or None.

    Lines and tabs are text.
    """
    if isinstance(value, str):
        return key if _CONTROL.search(value) else None
    return next((found for name, item in _within(value, key) if (found := not_printable(item, name))), None)


def not_finite(value: object, key: str = "") -> str | None:
    """Return the dotted key of the first NaN, infinity or integer beyond 64 bits in nested tables, or None."""
    if isinstance(value, float):
        return None if math.isfinite(value) else key
    if isinstance(value, int):
        return None if abs(value) < _BEYOND else key
    return next((found for name, item in _within(value, key) if (found := not_finite(item, name))), None)


def _within(value: object, key: str) -> Iterator[tuple[str, object]]:
    if isinstance(value, dict):
        yield from ((f"{key}.{name}" if key else str(name), item) for name, item in value.items())
    elif isinstance(value, list):
        yield from ((f"{key}[{index}]", item) for index, item in enumerate(value))


def load_scenario(path: Path) -> Scenario:
    """Read the simulator's part of a mission file.

    Raises:
        ScenarioError: With file, key and reason.
    """
    try:
        return msgspec.convert(read_toml(path), Scenario, strict=True)
    except msgspec.ValidationError as error:
        raise ScenarioError(f"{path}: {error_sentence(error)}") from error


def error_sentence(error: msgspec.ValidationError) -> str:
    """Return msgspec's complaint as key, reason and full stop."""
    reason, _, where = str(error).rpartition(" - at `$")
    if not reason:
        return f"{error}."
    key = where.rstrip("`").removeprefix(".")
    return f"{key}: {reason}."
