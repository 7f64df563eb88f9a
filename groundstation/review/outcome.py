"""What a recorded flight came to: the mission's director, fed from the recording instead of live."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from groundstation.pilot.surroundings import USUAL_RADIUS
from groundstation.recording import lanes, schema
from groundstation.review.flight import Flight, Numbers
from groundstation.training.director import Director, Figures, Stage
from groundstation.training.mission import Mission
from groundstation.training.score import Score, score_of
from sim.airframe import load_airframe
from sim.environment.world import World
from sim.scenario import ScenarioError

COUPLED = frozenset({"engaged", "on leash"})


class Outcome(NamedTuple):
    """How a flight ended.

    Attributes:
        completed: The mission's criteria hold; None where it has no target, or none was flown.
        result: In words.
        shortcomings: Each criterion that does not hold, in words.
        score: None where there is nothing to be judged by.
        figures: What it came to; None where no mission was flown.
    """

    completed: bool | None
    result: str
    shortcomings: tuple[str, ...] = ()
    score: Score | None = None
    figures: Figures | None = None


def outcome_of(flight: Flight) -> Outcome:
    """Return what a flight came to."""
    mission = flight.mission
    if mission is None:
        return Outcome(None, "no mission")
    director = directed(flight, mission)
    figures = director.figures
    if director.stage is Stage.WAITING:
        return Outcome(None, "did not take off", figures=figures)
    if not mission.judged:
        words = "landed" if director.stage is Stage.DONE else "in the air at the end of the recording"
        return Outcome(None, words, figures=figures)
    shortcomings = tuple(director.shortcomings())
    words = "; ".join(shortcomings) or "completed"
    return Outcome(not shortcomings, words, shortcomings, score_of(mission, figures), figures)


def directed(flight: Flight, mission: Mission) -> Director:
    """Return the director of a mission that has seen all of a flight."""
    director = Director(mission, World(mission.obstacle), radius_of(mission))
    t, positions = flight.series(schema.POSITION)
    words = words_at(flight, lanes.VEHICLE, t)
    known = np.isfinite(positions.sum(axis=1))
    for when, (x, y, z, yaw), word, good in zip(t.tolist(), positions.tolist(), words, known, strict=True):
        if good:
            in_air = word == "in air"
            director.vehicle(when, (x, y, z, yaw), in_air=in_air, armed=in_air or word == "armed")
    _controlled(flight, director)
    return director


def _controlled(flight: Flight, director: Director) -> None:
    """Show the director error and force while the hand was coupled."""
    t, errors = flight.series(schema.ERROR)
    force_t, forces = flight.series(schema.HANDLE_FORCE)
    if not len(force_t):
        return
    newest = np.maximum(np.searchsorted(force_t, t, side="right") - 1, 0)
    phases = words_at(flight, lanes.PHASE, t)
    rows = zip(errors[:, :3].tolist(), forces[newest].tolist(), phases, strict=True)
    for (ex, ey, ez), (fx, fy, fz), phase in rows:
        if phase in COUPLED:
            director.controller((ex, ey, ez), (fx, fy, fz))


def words_at(flight: Flight, lane: lanes.Lane, t: Numbers) -> list[str]:
    """Return a lane's word at each time, "" before its first."""
    changes = flight.states(lane)
    words = ["", *(word for _, word in changes)]
    places = np.searchsorted(np.array([when for when, _ in changes]), t, side="right")
    return [words[place] for place in places]


def radius_of(mission: Mission) -> float:
    """Return the hull's radius, m; the usual one where the airframe's file has gone since."""
    try:
        return load_airframe(mission.vehicle.airframe).radius
    except ScenarioError:
        return USUAL_RADIUS
