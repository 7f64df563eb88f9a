"""What the pilot knows of vehicle and world before it flies: size, velocity response, obstacles, fence."""

from __future__ import annotations

from typing import NamedTuple

from groundstation.run import Run
from sim.airframe import load_airframe
from sim.models.dynamic import Chi
from sim.scenario import Obstacle

# The usual multirotor's hull, m, where no airframe says it.
USUAL_RADIUS = 0.5


class Surroundings(NamedTuple):
    """What shield, cues and compensation reckon with.

    Attributes:
        obstacles: Known ones, world.
        radius: Of a sphere around the vehicle, m.
        chi: The vehicle's velocity response where it is known: then it can be compensated.
    """

    obstacles: tuple[Obstacle, ...] = ()
    radius: float = USUAL_RADIUS
    chi: Chi | None = None


NOTHING_KNOWN = Surroundings()


def surroundings_of(run: Run) -> Surroundings:
    """Return what is known in a run.

    A simulated vehicle is what the mission says, and only its identified model answers as χ does; a real one is what
    `control.airframe` says, if anything.

    Raises:
        ScenarioError: The airframe cannot be used.
    """
    mission = run.mission
    obstacles = mission.obstacle if mission else ()
    if run.simulated and mission:
        airframe = load_airframe(mission.vehicle.airframe)
        return Surroundings(
            obstacles, airframe.radius, airframe.chi if mission.vehicle.model == "dynamic" else None
        )
    if run.simulated or not run.settings.control.airframe:
        return Surroundings(obstacles)
    airframe = load_airframe(run.settings.control.airframe)
    return Surroundings(obstacles, airframe.radius, airframe.chi)
