"""Flies a recorded hand through the simulator, in virtual time."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.local_site import handle_at
from groundstation.evaluation.sample import Observer, Sample
from groundstation.evaluation.trial import scenario_of
from groundstation.pilot.controller import Controller
from groundstation.replay.hand import recorded_hand
from groundstation.review.flight import Flight
from groundstation.review.series import FlightSeries
from groundstation.review.series_recorder import SeriesRecorder
from groundstation.training.mission import Mission
from sim.airframe import load_airframe
from sim.conditions import BothWays
from sim.scenario import ScenarioError

# Of the servo and of the handle that is held.
RATE_HZ = 1000.0
# The coupling itself takes this at most, s.
_COUPLING_S = 5.0


class What(NamedTuple):
    """What is flown.

    Attributes:
        settings: The pilot's.
        mission: Whose world and vehicle.
        controller: Another than the paper's.
        channel: What it does, each way.
        seed: Of all that is random.
    """

    settings: Settings
    mission: Mission
    controller: Controller | None
    channel: BothWays
    seed: int


class NotCoupledError(Exception):
    """The hand could not be coupled in the replay; the message says why."""


class Replay:
    """A recorded hand on the handle of a virtual flight that is in the air, about to be coupled.

    Args:
        flight: The recording.
        what: What is flown.
        observers: Makes those that see it, besides the replay itself.

    Raises:
        InputError: The hand was never coupled, or the airframe cannot be used.
        TakeOffError: The vehicle does not come to hover.
    """

    def __init__(
        self, flight: Flight, what: What, observers: Callable[[VirtualFlight], Sequence[Observer]]
    ) -> None:
        self._hand = recorded_hand(flight, handle_at(RATE_HZ).workspace, what.settings)
        heading = what.settings.mapping.frame == "heading"
        self._others: Sequence[Observer] = ()
        setup = Setup(
            scenario_of(what.mission, what.mission.wind),
            what.mission.takeoff_altitude_m,
            what.settings,
            rate=RATE_HZ,
            up=what.channel.up,
            down=what.channel.down,
            seed=what.seed,
            controller=what.controller,
            fence=what.mission.fence,
            operator=self._hand,
        )
        try:
            radius = load_airframe(what.mission.vehicle.airframe).radius
            self._recorder = SeriesRecorder(what.mission.obstacle, radius, heading=heading)
            self._flight = VirtualFlight(
                setup, lambda _mapping, _device: self._hand, (self._observe,), self._hand
            )
        except ScenarioError as error:
            raise InputError(str(error)) from error
        self._others = observers(self._flight)

    @property
    def seconds(self) -> float:
        """From the recorded hand's first coupling to its last release."""
        return self._hand.seconds

    @property
    def collisions(self) -> int:
        """With obstacles, so far."""
        return len(self._flight.vehicle.collisions)

    def fly(self) -> FlightSeries:
        """Fly to the end of the recorded hand and return what was flown.

        Raises:
            NotCoupledError: The hand never came to be coupled.
        """
        self._flight.fly(self._hand.seconds + _COUPLING_S, lambda: self._hand.done)
        if not self._recorder.coupled:
            raise NotCoupledError("over this channel the hand is never coupled; choose a better --channel.")
        return self._recorder.series()

    def _observe(self, sample: Sample) -> None:
        self._recorder(sample)
        for observer in self._others:
            observer(sample)


class Pace:
    """An observer that holds a virtual flight back to a multiple of life.

    Args:
        speed: How many times life.
        clock, sleep: Monotonic seconds, and waiting.
    """

    def __init__(
        self,
        speed: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._speed, self._clock, self._sleep = speed, clock, sleep
        self._began: tuple[float, float] | None = None

    def __call__(self, sample: Sample) -> None:
        """Wait until it is time for a sample."""
        if self._began is None:
            self._began = (self._clock(), sample.t)
        since, start = self._began
        early = (sample.t - start) / self._speed - (self._clock() - since)
        if early > 0.0:
            self._sleep(early)
