"""Missions out of a seed: obstacle courses that can be flown whatever the seed."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Literal, NamedTuple, get_args

from msgspec.structs import replace

from groundstation.config import Settings
from groundstation.training import layouts
from groundstation.training.checking import holds, length
from groundstation.training.layouts import ALTITUDE_M, Grade, Layout
from groundstation.training.mission import Criteria, Mission, Skill, Target
from sim.airframe import load_airframe
from sim.scenario import EstimateChoice, Turbulence, VehicleChoice, Wind

Kind = Literal["slalom", "gates", "forest", "corridor"]
KINDS: tuple[Kind, ...] = get_args(Kind)
USUAL_AIRFRAME = "hummingbird"
# Speed in the mean that leaves a learner time, m/s, and what take-off, landing and looking around take, s.
_UNHURRIED_MPS, _AROUND_S = 0.5, 25.0
# Of the airframe's speed the wind is no more than this share.
_WIND_SHARE = 0.4

GRADES: dict[int, Grade] = {
    1: Grade(1.0, 3, math.radians(10.0)),
    2: Grade(0.8, 4, math.radians(18.0)),
    3: Grade(0.6, 5, math.radians(26.0)),
    4: Grade(0.45, 6, math.radians(34.0), 1.2, 0.1),
    5: Grade(0.3, 7, math.radians(42.0), 2.0, 0.2),
}


class _Words(NamedTuple):
    title: str
    teaches: str
    watch: tuple[str, ...]
    skills: tuple[Skill, ...]


_LAID: dict[Kind, Callable[[random.Random, Grade, float], Layout]] = {
    "slalom": layouts.slalom,
    "gates": layouts.gates,
    "forest": layouts.forest,
    "corridor": layouts.corridor,
}
_WORDS: dict[Kind, _Words] = {
    "slalom": _Words(
        "Slalom",
        "Change sides in time: begin the turn before you are beside a pole.",
        ("Look two poles ahead.", "If the guard slows you, you turned too late."),
        ("obstacles", "path"),
    ),
    "gates": _Words(
        "Gates",
        "Line up before a gate, and go through its middle.",
        ("Line up two metres before a gate.", "Height: the openings are not equally high."),
        ("obstacles", "path"),
    ),
    "forest": _Words(
        "Forest",
        "Find the way between trees without touching one.",
        ("The environment cue pushes away from the nearest tree.", "The next mark, then the one behind it."),
        ("obstacles", "path"),
    ),
    "corridor": _Words(
        "Corridor",
        "Face a wall and stay there, with another at your back.",
        ("Turn first, then move.", "The clearance to both walls."),
        ("inspection", "yaw", "obstacles"),
    ),
}


def course(kind: Kind, seed: int, level: int, airframe: str = USUAL_AIRFRAME, name: str = "") -> Mission:
    """Return a course; the same arguments give the same one.

    Args:
        kind: What it is made of.
        seed: Of where things stand.
        level: 1 to 5: less room, more of it, sharper turns, from 4 on wind.
        airframe: That shall have room: a preset's name or a file.
        name: The mission's; without one, kind and seed.

    Raises:
        ScenarioError: There is no such airframe.
    """
    grade, dice, words = GRADES[level], random.Random(seed), _WORDS[kind]
    body = load_airframe(airframe)
    room = body.radius + Settings().shield.margin + grade.spare
    laid = _LAID[kind](dice, grade, room)
    speed, toward = min(grade.wind, _WIND_SHARE * body.horizontal_speed), dice.uniform(0.0, math.tau)
    wind = (round(speed * math.cos(toward), 1), round(speed * math.sin(toward), 1), 0.0)
    mission = Mission(
        schema=1,
        name=name or f"{kind}-{seed}",
        title=f"{words.title}: level {level}, from seed {seed}",
        teaches=words.teaches,
        watch=words.watch,
        skills=(*words.skills, "wind") if grade.wind else words.skills,
        level=level,
        takeoff_altitude_m=ALTITUDE_M,
        route=laid.route,
        target=Target(laid.end, radius=0.4, hold_s=2.0),
        vehicle=VehicleChoice(airframe),
        wind=Wind(mean=wind, turbulence=Turbulence(intensity=grade.turbulence)),
        obstacle=laid.obstacles,
        estimate=EstimateChoice("rtk"),
    )
    return replace(mission, criteria=Criteria(time_limit_s=time_for(mission), final_error_m=0.3))


def time_for(mission: Mission) -> float:
    """Return a time limit that hurries nobody, s, in tens."""
    return 10.0 * math.ceil((_AROUND_S + 2.0 * sum(holds(mission)) + length(mission) / _UNHURRIED_MPS) / 10.0)
