"""A mission flown in virtual time by a simulated person, seen as the screen sees it: by records and a director."""

from __future__ import annotations

import math
from collections.abc import Callable

from canned_flight import NOTHING, canned_run
from msgspec.structs import replace

from drivers.arm import Arm
from groundstation.config import Settings
from groundstation.console import Snapshot
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import OperatorHand
from groundstation.evaluation.operator import Steady
from groundstation.evaluation.sample import Sample
from groundstation.evaluation.trial import scenario_of
from groundstation.frames import body_from_world
from groundstation.messages import DeviceReport, Handle, Phase, PilotState, VehicleState
from groundstation.pilot.choices import GUIDED_CUES, Choices
from groundstation.training.coach import LiveCoach
from groundstation.training.director import Director
from groundstation.training.guide import guide_of
from groundstation.training.mission import find_mission, load_mission
from groundstation.training.way import off_the_way, way_of
from sim.airframe import load_airframe
from sim.environment.world import World
from sim.operator import Operator, Person

WORKSPACE_M = 0.1


def as_records(sample: Sample) -> Snapshot:
    """Return what would be on the bus."""
    t, outputs, (forward, left, up, turn) = sample.t, sample.outputs, sample.v
    velocity = (*body_from_world((forward, left, up), -sample.p[3]), turn)
    values = {
        "t": t,
        "handle": Handle(t=t, position=sample.handle.position, yaw=sample.handle.yaw, force=outputs.force),
        "pilot": PilotState(
            t=t,
            phase=sample.phase,
            on_leash=outputs.on_leash,
            waiting=outputs.reference.waiting,
            error=outputs.error,
        ),
        "vehicle": VehicleState(t=t, position=sample.p, velocity=velocity, valid=1),
        "device": DeviceReport(t=t, workspace=WORKSPACE_M),
    }
    return Snapshot(**{name: getattr(NOTHING, name) for name in NOTHING.__slots__} | values)


class Coached:
    """A flight of a mission by a person, coached.

    Args:
        name: Of the mission.
        person: Who flies.
        seed: Of all that is random.
        guidance: How strongly the hand is guided.

    Attributes:
        hints: What the coach told, with when, s.
        director: Follows the mission.
    """

    def __init__(self, name: str, person: Person, seed: int = 0, guidance: float = 0.0) -> None:
        mission = self.mission = load_mission(find_mission(name))
        self.hints: list[tuple[float, str]] = []
        run = replace(canned_run(), mission=mission, settings=Settings())
        self._coach = LiveCoach(run, lambda words: self.hints.append((self.flight.t, words)))
        self._operator = Operator(mission.way[:-1], mission.way[-1], person, seed)
        self.director = Director(
            mission, World(mission.obstacle), load_airframe(mission.vehicle.airframe).radius
        )
        self._way = way_of(mission)
        self._squares: list[float] = []
        setup = Setup(
            scenario_of(mission, mission.wind), mission.takeoff_altitude_m, rate=250.0, seed=seed,
            fence=mission.fence, operator=Steady(Choices(cues=GUIDED_CUES)), way=self._way, guidance=guidance,
        )  # fmt: skip
        arm = Arm(person.arm_mass, person.arm_stiffness)
        self.flight = VirtualFlight(
            setup, lambda mapping, _: OperatorHand(self._operator, mapping), (self._look,), arm
        )

    def fly(self, seconds: float, finished: Callable[[], bool] | None = None) -> None:
        """Fly for so long, or until the target is held as far as the operator can tell."""
        self.flight.fly(seconds, finished or (lambda: self._operator.arrived))

    @property
    def path_error(self) -> float:
        """Root mean square of the distance from the mission's way while coupled, m."""
        return math.sqrt(sum(self._squares) / len(self._squares))

    def _look(self, sample: Sample) -> None:
        self.director.vehicle(sample.t, sample.p, in_air=True, armed=True)
        if sample.phase is Phase.ENGAGED:
            self._squares.append(off_the_way(self._way, self.director.leg, sample.p[:3]) ** 2)
        self._coach.look(as_records(sample), guide_of(self.director, sample.t), self.director.clearance)
