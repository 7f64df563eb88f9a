"""One mission flown from take-off to landing in virtual time, by a simulated operator or by a hand that does nothing.

It is measured as a live flight is: by what the vehicle tells the ground of itself, not by what it truly does.
"""

from __future__ import annotations

import math
import time

from msgspec import Struct

from drivers.arm import Arm
from drivers.device import DeviceInfo
from groundstation.config import Settings
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import CENTRE
from groundstation.evaluation.referee import disagreement
from groundstation.evaluation.remote_site import TakeOffError
from groundstation.evaluation.sample import Sample
from groundstation.evaluation.trial import scenario_of
from groundstation.messages import Phase
from groundstation.operators.happenings import Happenings
from groundstation.operators.pupil import Pupil
from groundstation.pilot.choices import Choices
from groundstation.pilot.chooser import beginning
from groundstation.pilot.mapping import Displacement, RateMapping
from groundstation.pilot.sight import VehicleSample
from groundstation.training.director import Stage
from groundstation.training.events import Timetable
from groundstation.training.measurer import HandSight, Measurer, VehicleSight
from groundstation.training.measures import Measures, Track
from groundstation.training.mission import Mission
from sim.airframe import load_airframe
from sim.kinematics import world_rates
from sim.people import PEOPLE
from sim.simulator import Simulator

# A hand that leaves the handle alone from take-off on, and only lands when that is all there is left to do.
NOBODY = "nobody"
# A quarter of the real servo's rate, and of its cost. With it the expert's slalom, landing and wind take the same
# time as at 1000 Hz to the last digit, on two seeds each. The way is off by 0.1 mm at most, clearance by 3 mm, the
# RMS of p̃ by 1 mm and the effort by 0.003 N: less than from seed to seed.
RATE_HZ = 250.0
# A landing that takes longer is none, s: the autopilot sinks at 0.7 m/s.
_LANDING_S = 60.0
_TRACK_EVERY_S = 0.5
_CLIMB_SEEN_EVERY_S = 0.02


class Exercise(Struct, frozen=True):
    """What is flown, and by whom.

    Attributes:
        mission: As read from its file.
        operator: A name in `sim.people`, or `NOBODY`.
        seed: Of all that is random: operator, air, estimate, channel.
        rate: Of the servo, Hz: a multiple of 250.
        settings: The pilot's.
    """

    mission: Mission
    operator: str
    seed: int
    rate: float = RATE_HZ
    settings: Settings = Settings()


class Flown(Struct, frozen=True):
    """What came of it.

    Attributes:
        operator, seed: Of the exercise.
        measures: The flight in numbers.
        shortcomings: Each criterion of the mission that is not met, in words.
        track: Where it went.
        uncoupled: How often the hand was uncoupled against its will.
        flown: Virtual time of the flight, s.
        processor: Processor time that it took, s.
    """

    operator: str
    seed: int
    measures: Measures = Measures()
    shortcomings: tuple[str, ...] = ()
    track: Track = Track(_TRACK_EVERY_S)
    uncoupled: int = 0
    flown: float = 0.0
    processor: float = 0.0


def fly(exercise: Exercise) -> Flown:
    """Fly to the landing, the time limit, or until the motors stopped.

    Raises:
        ScenarioError: The airframe cannot be used, or an obstacle stands on the pad.
    """
    began = time.thread_time()
    try:
        outing = _Outing(exercise)
    except TakeOffError as error:
        return Flown(exercise.operator, exercise.seed, shortcomings=(str(error),))
    outing.fly()
    measurer, flight = outing.measurer, outing.flight
    return Flown(
        exercise.operator,
        exercise.seed,
        measurer.measures(),
        tuple(measurer.director.shortcomings()),
        Track(_TRACK_EVERY_S, tuple(outing.points)),
        flight.local.coupling.losses,
        flight.t,
        time.thread_time() - began,
    )


class _Outing:
    """A flight and all that takes part in it; also its hand and its operator, as `VirtualFlight` asks for them.

    Attributes:
        flight: In the air.
        measurer: Sees what the ground sees.
        points: Of the track so far.
    """

    def __init__(self, exercise: Exercise) -> None:
        mission, name = exercise.mission, exercise.operator
        self._limit = mission.criteria.time_limit_s
        self._pupil = None if name == NOBODY else Pupil(mission, PEOPLE[name], exercise.seed)
        self._timetable = Timetable(mission.event)
        self._choices = beginning(exercise.settings).choices
        self._seen_t = -math.inf
        self._mapping: RateMapping | None = None
        self.points: list[tuple[float, float, float]] = []
        self.measurer = Measurer(mission, load_airframe(mission.vehicle.airframe).radius)
        person = PEOPLE.get(name, PEOPLE["average"])
        setup = Setup(
            scenario_of(mission, mission.wind),
            altitude=mission.takeoff_altitude_m,
            settings=exercise.settings,
            rate=exercise.rate,
            seed=exercise.seed,
            fence=mission.fence,
            operator=self,
            hesitates=person.recovers,
        )
        arm = Arm(person.arm_mass, person.arm_stiffness)
        self.flight = VirtualFlight(setup, self._grip, (self._look,), arm, self._climb)
        self._happenings = Happenings(self.flight)

    def fly(self) -> None:
        """Fly the mission, then let go and land."""
        flight = self.flight
        flight.fly(self._limit - flight.t, lambda: self._down or self._through)
        if self._through and not self._down:
            flight.local.coupling.land()
            flight.fly(_LANDING_S, lambda: self._down)

    @property
    def _through(self) -> bool:
        return self._pupil.through if self._pupil else self.measurer.director.at_the_end

    @property
    def _down(self) -> bool:
        return self.measurer.director.stage is Stage.DONE

    # What the flight asks of hand and operator.

    def couples(self) -> bool:
        """Whoever flies is coupled as soon as that can be."""
        return self._pupil is not None

    def choices(self) -> Choices:
        """Return what the settings choose."""
        return self._choices

    def decide(self, t: float, vehicle: VehicleSample) -> Displacement:
        """Return where the handle should be for what the pupil wishes."""
        if self._pupil is None or self._mapping is None:
            return CENTRE
        (vx, vy, vz, _), yaw = vehicle.velocity, vehicle.position[3]
        end, director = self.flight.local.end, self.measurer.director
        wish = self._pupil.decide(t, vehicle.position, (vx, vy, vz), director, end.round_trip)
        return self._mapping.displacement_for(wish, yaw)

    def _grip(self, mapping: RateMapping, _: DeviceInfo) -> _Outing:
        self._mapping = mapping
        return self

    # What is seen.

    def _climb(self, vehicle: Simulator) -> None:
        """See the take-off, of which only the vehicle's telemetry tells."""
        took_off = vehicle.autopilot.took_off_t
        if took_off is None or vehicle.t - self._seen_t < _CLIMB_SEEN_EVERY_S:
            return
        self._seen_t = vehicle.t
        p, v, _ = vehicle.estimate
        self._note(vehicle.t, VehicleSample(p, world_rates(p[3], v)), armed=vehicle.autopilot.armed)

    def _look(self, sample: Sample) -> None:
        """See what came from the vehicle, and the hand; let happen what is due."""
        local = self.flight.local
        end, outputs = local.end, sample.outputs
        report = end.report
        coupled = sample.phase is Phase.ENGAGED
        x, y, z, _ = outputs.error
        self.measurer.hand(
            HandSight(
                local.t, coupled, (x, y, z), disagreement(outputs), outputs.force, outputs.reference.on_leash
            )
        )
        if report is not None and end.heard_t > self._seen_t:
            self._seen_t = end.heard_t
            self._note(end.heard_t, report.sample, armed=report.armed)
        director = self.measurer.director
        for event in self._timetable.due(director.elapsed(local.t), director.leg):
            self._happenings.begin(event)
        self._happenings.go_on()

    def _note(self, t: float, vehicle: VehicleSample, *, armed: bool) -> None:
        (vx, vy, vz, _), (x, y, z, _) = vehicle.velocity, vehicle.position
        director = self.measurer.director
        self.measurer.vehicle(VehicleSight(t, vehicle.position, (vx, vy, vz), armed, in_air=armed))
        if director.elapsed(t) >= _TRACK_EVERY_S * len(self.points):
            self.points.append((round(x, 2), round(y, 2), round(z, 2)))
