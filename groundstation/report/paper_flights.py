"""The paper's experiments flown in virtual time: the virtual environment without wind, the real one with it.

The paper flies a DJI Phantom 4, first as a dynamic model in a virtual environment (its figure 9), then outdoors
among fixed obstacles (figure 10). Here the first is the Phantom's velocity response without wind, which knows where
it is; the second its rigid body, in the mission's wind, with the estimate of a good receiver. A third is the second
again with what this program adds to the paper's force.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from msgspec.structs import replace

from groundstation.config import Control, Mapping, Settings
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import OperatorHand
from groundstation.evaluation.sample import Sample
from groundstation.evaluation.trial import scenario_of
from groundstation.review.series import FlightSeries
from groundstation.review.series_recorder import SeriesRecorder
from groundstation.training.director import Director
from groundstation.training.mission import Mission, find_mission, load_mission
from sim.airframe import load_airframe
from sim.environment.world import World
from sim.operator import Operator
from sim.scenario import EstimateChoice, VehicleChoice, Wind

# On the axes of the paper's fixed frame: equations (4) and (5) and nothing else, and what the program adds.
PAPER = Settings(mapping=Mapping(frame="world"), control=Control(preset="paper"))
ASSISTED = replace(PAPER, control=Control(preset="assisted"))
# Long enough for the hand to settle: the paper's figure 12 shows errors that have converged.
_HOLD_S = 10.0
_AIRFRAME = "phantom"

# Told with every sample how the mission is going.
Watcher = Callable[[Director], None]


class Flown(NamedTuple):
    """A flight that was flown.

    Attributes:
        series: From coupling to the end of the hold.
        mission: What was flown.
        radius: Of the vehicle, m.
        collisions: With obstacles.
        held: The target was reached and held.
    """

    series: FlightSeries
    mission: Mission
    radius: float
    collisions: int
    held: bool


class Flights(NamedTuple):
    """All of them: without wind, in wind, and in wind with what this program adds."""

    calm: Flown
    windy: Flown
    assisted: Flown


def fly_all(mission: Mission, seed: int, announce: Callable[[str], Watcher]) -> Flights:
    """Fly them one after the other.

    Args:
        mission: With its wind, and a target.
        seed: Of all that is random: hand, air, estimate.
        announce: Told what is flown next; returns who watches it.
    """
    virtual = VehicleChoice(airframe=_AIRFRAME, model="dynamic")
    real = VehicleChoice(airframe=_AIRFRAME, model="rigid_body")
    calm = replace(mission, vehicle=virtual, wind=Wind(), estimate=EstimateChoice("ideal"))
    windy = replace(mission, vehicle=real)
    return Flights(
        fly(calm, PAPER, seed, announce("without wind")),
        fly(windy, PAPER, seed, announce("in wind")),
        fly(windy, ASSISTED, seed, announce("in wind, assisted")),
    )


def paper_mission() -> Mission:
    """Return the mission after the paper's experiment, with a hold in which errors can converge."""
    mission = load_mission(find_mission("paper"))
    assert mission.target is not None
    return replace(mission, target=replace(mission.target, hold_s=_HOLD_S))


def fly(mission: Mission, settings: Settings, seed: int, watch: Watcher) -> Flown:
    """Fly a mission with a target to the end of its hold, or to its time limit.

    Args:
        mission: What to fly.
        settings: The pilot's, with the mapping's frame the world's.
        seed: Of all that is random: hand, air, estimate.
        watch: Told with every sample how it is going.
    """
    assert mission.target is not None
    target = mission.target.position
    operator = Operator(mission.way[:-1], target, seed=seed)
    setup = Setup(scenario_of(mission, mission.wind), mission.takeoff_altitude_m, settings, seed=seed)
    radius = load_airframe(mission.vehicle.airframe).radius
    director = Director(mission, World(mission.obstacle), radius)
    recorder = SeriesRecorder(mission.obstacle, radius)

    def observe(sample: Sample) -> None:
        director.vehicle(sample.t, sample.p, in_air=True, armed=True)
        recorder(sample)
        watch(director)

    flight = VirtualFlight(setup, lambda mapping, _: OperatorHand(operator, mapping), (observe,))
    flight.fly(mission.criteria.time_limit_s, lambda: director.at_the_end)
    held = director.at_the_end
    return Flown(recorder.series(), mission, radius, len(flight.vehicle.collisions), held)
