"""Flies one case of an evaluation: from the task to the outcome."""

from __future__ import annotations

import math
import time
from random import Random

import msgspec

from drivers.device import DeviceInfo
from groundstation.evaluation.case import Case, Outcome, Result, Task
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import OperatorHand
from groundstation.evaluation.referee import Referee
from groundstation.evaluation.remote_site import TakeOffError
from groundstation.evaluation.sample import Observer
from groundstation.messages import Preset
from groundstation.pilot.guest import load_controller
from groundstation.pilot.mapping import RateMapping
from groundstation.training.mission import Mission
from sim.airframe import load_airframe
from sim.channel import Conditions
from sim.operator import Operator
from sim.people import PEOPLE, accustomed
from sim.scenario import Scenario, Wind

CALM, AS_IN_MISSION = "calm", "mission"
PRESET_NAMES = tuple(preset.name.lower() for preset in Preset)
# After the time limit of the mission nobody waits for the landing longer than this, s.
_LANDING_S = 30.0


def fly(task: Task, observers: tuple[Observer, ...] = ()) -> Result:
    """Fly a task to its end: the target held and the vehicle landed, the time limit, or the motors stopped.

    Args:
        task: What to fly.
        observers: See it besides the referee.

    Raises:
        InputError: The controller cannot be made here.
        ScenarioError: The airframe cannot be used, or an obstacle stands on the pad.
    """
    began = time.thread_time()
    case, mission = task.case, task.mission
    referee = Referee(mission, load_airframe(case.airframe).radius)
    try:
        flight = VirtualFlight(setup(task), lambda m, d: _hand(task, m, d), (referee, *observers))
    except TakeOffError as error:
        return Result(task.id, case, Outcome(reason=str(error)))
    autopilot = flight.vehicle.autopilot

    def over() -> bool:
        return referee.target_held or not autopilot.armed

    flight.fly(mission.criteria.time_limit_s - flight.t, over)
    if referee.target_held:
        flight.local.coupling.land()
        flight.fly(_LANDING_S, lambda: not autopilot.armed)
        if not autopilot.armed:
            referee.landed(flight.t, flight.vehicle.p)
    return Result(task.id, case, referee.outcome(flight, time.thread_time() - began))


def setup(task: Task) -> Setup:
    """Return how a task is flown."""
    case, mission = task.case, task.mission
    channel = Conditions(delay=0.5 * case.delay, jitter=case.jitter, loss=case.loss)
    return Setup(
        scenario_of(mission, wind_of(case, mission.wind)),
        altitude=mission.takeoff_altitude_m,
        settings=task.settings,
        controller=None
        if case.controller in PRESET_NAMES
        else load_controller(case.controller, task.settings),
        rate=case.rate,
        up=channel,
        down=channel,
        seed=case.seed,
        fence=mission.fence,
    )


def scenario_of(mission: Mission, wind: Wind) -> Scenario:
    """Return the simulator's part of a mission, in another wind."""
    fields = {name: getattr(mission, name) for name in Scenario.__struct_fields__}
    return msgspec.structs.replace(Scenario(**fields), wind=wind)


def wind_of(case: Case, of_mission: Wind) -> Wind:
    """Return the wind of a case. The direction follows from the seed alone, so whatever is compared has the same."""
    if case.wind == AS_IN_MISSION:
        return of_mission
    if case.wind == CALM:
        return Wind()
    speed, toward = float(case.wind), Random(f"wind {case.seed}").uniform(0.0, math.tau)
    return Wind((speed * math.cos(toward), speed * math.sin(toward), 0.0))


def _hand(task: Task, mapping: RateMapping, _: DeviceInfo) -> OperatorHand:
    mission, case = task.mission, task.case
    assert mission.target is not None
    operator = Operator(
        mission.way[:-1], mission.way[-1], accustomed(PEOPLE[case.operator], case.delay), case.seed
    )
    return OperatorHand(operator, mapping)
