"""What the pilot knows of vehicle and world before it flies: size, velocity response, obstacles, fence."""

from __future__ import annotations

from typing import NamedTuple

from drivers.device import Vector3
from groundstation.run import Run
from groundstation.training.mission import Fence
from groundstation.training.way import way_of
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
        fence: Where the hand may take the vehicle; the settings' bounds where there is none.
        way: That the mission leads along, world, m.
        guidance: How strongly the hand is guided to it, 0 to 1.
    """

    obstacles: tuple[Obstacle, ...] = ()
    radius: float = USUAL_RADIUS
    chi: Chi | None = None
    fence: Fence | None = None
    way: tuple[Vector3, ...] = ()
    guidance: float = 0.0


NOTHING_KNOWN = Surroundings()


def surroundings_of(run: Run) -> Surroundings:
    """Return what is known in a run.

    A simulated vehicle is what the mission says, and only its identified model answers as χ does; a real one is what
    `control.airframe` says, if anything.

    Raises:
        ScenarioError: The airframe cannot be used.
    """
    mission, known = run.mission, NOTHING_KNOWN
    if mission:
        known = known._replace(obstacles=mission.obstacle, fence=mission.fence)
        known = known._replace(way=way_of(mission), guidance=run.guidance)
    if run.simulated and mission:
        airframe = load_airframe(mission.vehicle.airframe)
        answers = mission.vehicle.model == "dynamic"
    elif run.settings.control.airframe and not run.simulated:
        airframe, answers = load_airframe(run.settings.control.airframe), True
    else:
        return known
    return known._replace(radius=airframe.radius, chi=airframe.chi if answers else None)
