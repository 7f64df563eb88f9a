"""Mission files: what a flight is for, the world it happens in, and when it has succeeded.

The tables of the world are `sim.scenario`'s; the rest is here. A key that is not known is an error.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from groundstation.errors import InputError
from sim.scenario import (
    Charge,
    Contact,
    EstimateChoice,
    Name,
    NonNegative,
    Obstacle,
    Pad,
    Point,
    Positive,
    ScenarioError,
    VehicleChoice,
    Wind,
    error_sentence,
    read_toml,
)

SUFFIX = ".toml"
_PACKAGE = Path(__file__).resolve().parents[1]
# Installed from a wheel the missions lie inside the package, in a checkout beside it.
MISSIONS_FOLDER = next(
    (folder for folder in (_PACKAGE / "missions", _PACKAGE.parent / "missions") if folder.is_dir()), _PACKAGE
)


class MissionError(InputError):
    """A mission cannot be flown; the message names file, key and reason."""


class Target(Struct, frozen=True, forbid_unknown_fields=True):
    """Where the vehicle shall be brought to.

    Attributes:
        position: World, m.
        radius: Within this distance of it the vehicle counts as arrived, m.
        hold_s: How long it must stay there, s.
    """

    position: Point
    radius: Positive = 0.3
    hold_s: NonNegative = 3.0


class Criteria(Struct, frozen=True, forbid_unknown_fields=True):
    """When the flight has succeeded.

    Attributes:
        time_limit_s: From take-off to landing, s.
        final_error_m: Largest distance to the target's position at the end of the hold.
        max_collisions: Contacts with obstacles that are forgiven.
    """

    time_limit_s: Positive = 120.0
    final_error_m: Positive = 0.2
    max_collisions: Annotated[int, Meta(ge=0)] = 0


class Fence(Struct, frozen=True, forbid_unknown_fields=True):
    """Where the hand may take the vehicle: the shield keeps it there, in place of the settings' own bounds.

    Attributes:
        radius: Largest distance of the hull from the origin in the plane, m; 0 for none.
        ceiling: Highest altitude of the vehicle's middle, m; 0 for none.
        floor: Lowest, m.
    """

    radius: NonNegative = 0.0
    ceiling: NonNegative = 0.0
    floor: NonNegative = 0.5

    def __post_init__(self) -> None:
        if self.ceiling and self.ceiling <= self.floor:
            raise ValueError("the ceiling is not above the floor; raise one or lower the other")


class Mission(Struct, frozen=True, forbid_unknown_fields=True):
    """A mission file.

    Attributes:
        schema: Version of this format.
        name: Short, as in the file's name; recordings carry it.
        title: One line for people.
        teaches: What a trainee learns from it.
        takeoff_altitude_m: Where take-off ends, above the pad.
        route: Points the reference hand flies through before the target, world, m.
        target: Where it leads, or none: then the flight only takes off, holds and lands.
        fence: Where the hand may take the vehicle.
        vehicle, wind, obstacle, pad, contact, battery, estimate: The world, see `sim.scenario`. Gates are there to be
            flown through, each at least once.
    """

    schema: Literal[1]
    name: Name
    title: str
    teaches: str = ""
    takeoff_altitude_m: Annotated[float, Meta(ge=0.5, le=50)] = 2.0
    route: tuple[Point, ...] = ()
    target: Target | None = None
    criteria: Criteria = Criteria()
    fence: Fence | None = None
    vehicle: VehicleChoice = VehicleChoice()
    wind: Wind = Wind()
    obstacle: tuple[Obstacle, ...] = ()
    pad: tuple[Pad, ...] = ()
    contact: Contact = Contact()
    battery: Charge = Charge()
    estimate: EstimateChoice = EstimateChoice()


def load_mission(path: Path) -> Mission:
    """Read a mission file strictly.

    Raises:
        MissionError: With file, key and reason in one sentence.
    """
    try:
        mission = msgspec.convert(read_toml(path), Mission, strict=True)
    except ScenarioError as error:
        raise MissionError(str(error)) from error
    except msgspec.ValidationError as error:
        raise MissionError(f"{path}: {error_sentence(error)}") from error
    for table, things in (("obstacle", mission.obstacle), ("pad", mission.pad)):
        names = [thing.name for thing in things]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise MissionError(f"{path}: {table}: two are named {twice!r}; give each its own name.")
    return mission


def find_mission(name: str) -> Path:
    """Return the file of a mission given by path or by the name of one that comes with the program.

    Raises:
        MissionError: There is none; the message lists those there are.
    """
    given = Path(name)
    if given.suffix == SUFFIX or given.exists():
        return given
    shipped = MISSIONS_FOLDER / f"{name}{SUFFIX}"
    if shipped.is_file():
        return shipped
    known = ", ".join(sorted(path.stem for path in MISSIONS_FOLDER.glob(f"*{SUFFIX}"))) or "none"
    raise MissionError(f"{name}: no such mission; give a .toml file or one of: {known}.")
