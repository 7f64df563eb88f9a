"""Mission files: what a flight is for, the world it happens in, and when it has succeeded.

The tables of the world are `sim.scenario`'s; the rest is here. A key that is not known is an error.
"""

from __future__ import annotations

from math import dist
from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from groundstation.errors import InputError
from groundstation.training.events import Event
from sim.scenario import (
    Charge,
    Contact,
    Coordinate,
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
# What missions train. A mission's first is the one it is mainly for.
Skill = Literal[
    "feel", "hover", "axes", "yaw", "path", "landing", "obstacles", "inspection", "wind", "delay", "emergency"
]
_PACKAGE = Path(__file__).resolve().parents[1]
# Installed from a wheel the missions lie inside the package, in a checkout beside it.
MISSIONS_FOLDER = next(
    (folder for folder in (_PACKAGE / "missions", _PACKAGE.parent / "missions") if folder.is_dir()), _PACKAGE
)


class MissionError(InputError):
    """A mission cannot be flown; the message names file, key and reason."""


class Waypoint(Struct, frozen=True, forbid_unknown_fields=True):
    """A point of the route; a bare `[x, y, z]` in the file is one with these defaults.

    Attributes:
        at: World, m.
        radius: Within this distance of it the vehicle has reached it, m.
        hold_s: How long it must stay there, s.
        yaw_deg: Where its nose must point meanwhile, counter-clockwise from east; none: anywhere.
        say: What the trainee is told while it is next.
    """

    at: Point
    radius: Positive = 1.0
    hold_s: NonNegative = 0.0
    yaw_deg: Coordinate | None = None
    say: str = ""


class Target(Struct, frozen=True, forbid_unknown_fields=True):
    """Where the vehicle shall be brought to and kept.

    Attributes:
        position: World, m.
        radius: Within this distance of it the vehicle counts as arrived, m.
        hold_s: How long it must stay there, s.
        yaw_deg: Where its nose must point meanwhile, counter-clockwise from east; none: anywhere.
    """

    position: Point
    radius: Positive = 0.3
    hold_s: NonNegative = 3.0
    yaw_deg: Coordinate | None = None


class Landing(Struct, frozen=True, forbid_unknown_fields=True):
    """Where the flight must end: on the `pad` of that name, within its radius."""

    pad: Name


class Criteria(Struct, frozen=True, forbid_unknown_fields=True):
    """When the flight has succeeded.

    Attributes:
        time_limit_s: From take-off to landing, s.
        final_error_m: Largest distance to the target's position at the end of the hold.
        max_collisions: Contacts with obstacles that are forgiven.
        min_clearance_m: Nearer to an obstacle than this the hull may not come.
        min_points: Least score, 0 to 100.
    """

    time_limit_s: Positive = 120.0
    final_error_m: Positive = 0.2
    max_collisions: Annotated[int, Meta(ge=0)] = 0
    min_clearance_m: NonNegative = 0.0
    min_points: Annotated[float, Meta(ge=0, le=100)] = 0.0


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
        teaches: What a trainee learns from it, in a line.
        watch: What to watch while flying it, a line each.
        skills: What it trains; a trainee's weakest is what is to be repeated.
        level: How hard it is, 1 to 5.
        needs: Missions to be passed before this one.
        takeoff_altitude_m: Where take-off ends, above the pad.
        route: Points to be reached one after the other before the target.
        target: Where it leads, or none.
        landing: Where it must end, or none: anywhere.
        event: What happens on the way, to a simulated vehicle.
        fence: Where the hand may take the vehicle.
        vehicle, wind, obstacle, pad, contact, battery, estimate: The world, see `sim.scenario`. Gates are there to be
            flown through, each at least once.
    """

    schema: Literal[1]
    name: Name
    title: str
    teaches: str = ""
    watch: tuple[str, ...] = ()
    skills: tuple[Skill, ...] = ()
    level: Annotated[int, Meta(ge=1, le=5)] = 1
    needs: tuple[Name, ...] = ()
    takeoff_altitude_m: Annotated[float, Meta(ge=0.5, le=50)] = 2.0
    route: tuple[Waypoint | Point, ...] = ()
    target: Target | None = None
    landing: Landing | None = None
    event: tuple[Event, ...] = ()
    criteria: Criteria = Criteria()
    fence: Fence | None = None
    vehicle: VehicleChoice = VehicleChoice()
    wind: Wind = Wind()
    obstacle: tuple[Obstacle, ...] = ()
    pad: tuple[Pad, ...] = ()
    contact: Contact = Contact()
    battery: Charge = Charge()
    estimate: EstimateChoice = EstimateChoice()

    @property
    def waypoints(self) -> tuple[Waypoint, ...]:
        """The route, each point as a whole."""
        return tuple(each if isinstance(each, Waypoint) else Waypoint(each) for each in self.route)

    @property
    def way(self) -> tuple[Point, ...]:
        """The points from the first to the target or to above the pad, world, m.

        Where the last point lies over the pad already the descent begins there.
        """
        points = [each.at if isinstance(each, Waypoint) else each for each in self.route]
        if self.target:
            points.append(self.target.position)
        if pad := self.landing_pad:
            x, y, z = pad.position
            if not points or dist(points[-1][:2], (x, y)) > pad.radius:
                points.append((x, y, z + self.takeoff_altitude_m))
        return tuple(points)

    @property
    def path(self) -> tuple[Point, ...]:
        """The way, from where take-off ends."""
        return ((0.0, 0.0, self.takeoff_altitude_m), *self.way)

    @property
    def landing_pad(self) -> Pad | None:
        """Where the flight must end, or None."""
        return next((pad for pad in self.pad if self.landing and pad.name == self.landing.pad), None)

    @property
    def judged(self) -> bool:
        """There is something to be reached, so something to be judged by."""
        return bool(self.route or self.target or self.landing)


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
    if mission.landing and not mission.landing_pad:
        raise MissionError(
            f"{path}: landing.pad: there is no [[pad]] named {mission.landing.pad!r}; add one."
        )
    points = len(mission.waypoints) + (mission.target is not None)
    if late := next((event for event in mission.event if event.leg > points), None):
        raise MissionError(f"{path}: event: there are {points} points, so leg = {late.leg} never comes.")
    return mission


def find_mission(name: str) -> Path:
    """Return the file of a mission given by path or by the name of one that comes with the program.

    Raises:
        MissionError: There is none; the message lists those there are.
    """
    given = Path(name)
    if given.suffix == SUFFIX or (given.exists() and not given.is_dir()):
        return given
    shipped = MISSIONS_FOLDER / f"{name}{SUFFIX}"
    if shipped.is_file():
        return shipped
    known = ", ".join(sorted(path.stem for path in MISSIONS_FOLDER.glob(f"*{SUFFIX}"))) or "none"
    raise MissionError(f"{name}: no such mission; give a .toml file or one of: {known}.")
