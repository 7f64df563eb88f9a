"""The part of a mission file that the simulated world is made of: obstacles, wind, vehicle.

World frame ENU, origin on the ground where the vehicle starts; metres, seconds; degrees only where a name
says so. `groundstation.training.mission` reads the same tables strictly, with those that are not of the simulator.
"""

from __future__ import annotations

import math
import tomllib
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


Obstacle = Box | Cylinder | Sphere


class Gust(Struct, frozen=True, forbid_unknown_fields=True):
    """A discrete gust of 1-cosine shape added to the mean wind.

    Attributes:
        start_s: When it begins, s after take-off.
        duration_s: From calm to calm, s.
        velocity: Wind at its peak, m/s, ENU.
    """

    start_s: NonNegative
    duration_s: Positive
    velocity: Point


class Wind(Struct, frozen=True, forbid_unknown_fields=True):
    """Wind: a constant part, m/s ENU (where the air goes to), and gusts."""

    mean: Point = (0.0, 0.0, 0.0)
    gust: tuple[Gust, ...] = ()


class VehicleChoice(Struct, frozen=True, forbid_unknown_fields=True):
    """Which simulated vehicle flies the mission; a real one ignores it.

    Attributes:
        airframe: Name of a preset in `sim/airframes/`, or a path to a file like them.
        model: `kinematic` (equations 1-3, ideal) or `dynamic` (velocity response χ).
        yaw_deg: Heading on the pad, counter-clockwise from east.
    """

    airframe: str = "matrice_100"
    model: Literal["kinematic", "dynamic"] = "dynamic"
    yaw_deg: Coordinate = 0.0


class Scenario(Struct, frozen=True):
    """All that the simulator needs of a mission. Tables that are not its business are passed over here."""

    vehicle: VehicleChoice = VehicleChoice()
    wind: Wind = Wind()
    obstacle: tuple[Obstacle, ...] = ()


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
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise ScenarioError(f"{path}: is not valid TOML: {error}.") from error
    where = not_finite(tables)
    if where:
        raise ScenarioError(f"{path}: {where}: is not a finite number; give a plain number.")
    return tables


def not_finite(value: object, key: str = "") -> str | None:
    """Return the dotted key of the first NaN or infinity in nested tables, or None."""
    if isinstance(value, float):
        return None if math.isfinite(value) else key
    pairs: list[tuple[str, object]] = []
    if isinstance(value, dict):
        pairs = [(f"{key}.{name}" if key else str(name), item) for name, item in value.items()]
    elif isinstance(value, list):
        pairs = [(f"{key}[{index}]", item) for index, item in enumerate(value)]
    return next((found for name, item in pairs if (found := not_finite(item, name))), None)


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
