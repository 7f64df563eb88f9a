"""One flight in virtual time: the servo's own `Pilot.step`, a hand, a link with delay and loss, a simulated vehicle.

Both sites of the paper's figure 3, without clock, processes or sockets: the pilot ticks at the servo's rate, the
vehicle steps at 250 Hz, setpoints and telemetry cross the channel at the rates of the settings. The gate of the
real link has nothing to do here: nothing hangs in virtual time, so a setpoint leaves in the tick that makes it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from drivers.device import DeviceInfo, Vector3
from groundstation.config import Settings
from groundstation.evaluation.channel_ends import Link
from groundstation.evaluation.hands import Hand
from groundstation.evaluation.local_site import LocalSite, Mover, handle_at
from groundstation.evaluation.operator import Operator, Steady
from groundstation.evaluation.remote_site import STEP_S, RemoteSite
from groundstation.evaluation.sample import Observer, Sample
from groundstation.pilot.chooser import beginning
from groundstation.pilot.controller import Controller
from groundstation.pilot.mapping import RateMapping
from groundstation.pilot.pilot import Pilot
from groundstation.pilot.surroundings import Surroundings
from groundstation.training.mission import Fence
from sim.channel import IDEAL, Conditions
from sim.scenario import Scenario
from sim.simulator import Simulator, build

STEPS_HZ = round(1.0 / STEP_S)


class Setup(NamedTuple):
    """What is flown, by which settings and over what.

    Attributes:
        scenario: The world and the vehicle in it.
        altitude: Where the take-off ends and the hand is coupled, m.
        settings: The pilot's.
        rate: Of the servo, Hz: a multiple of 250.
        up, down: What the channel does, to the vehicle and from it.
        seed: Of all that is random: air, estimate, channel.
        controller: Another than the paper's.
        fence: Where the hand may take the vehicle.
        operator: Couples and chooses; unless given, is coupled and keeps to what the settings choose.
        way: That the hand is guided to, world, m.
        guidance: How strongly, 0 to 1; the operator chooses the cue.
        hesitates: How long that takes after a coupling was lost and could be had again, s.
    """

    scenario: Scenario
    altitude: float = 2.0
    settings: Settings = Settings()
    rate: float = 1000.0
    up: Conditions = IDEAL
    down: Conditions = IDEAL
    seed: int = 0
    controller: Controller | None = None
    fence: Fence | None = None
    operator: Operator | None = None
    way: tuple[Vector3, ...] = ()
    guidance: float = 0.0
    hesitates: float = 0.0


def _unseen(_: Simulator) -> None:
    """Pass over the climb."""


# Makes the hand that fits a mapping and a handle.
HandMaker = Callable[[RateMapping, DeviceInfo], Hand]


class VirtualFlight:
    """A vehicle in the air, and the hand that is about to be coupled to it.

    Args:
        setup: What is flown.
        hand: Makes the one on the handle.
        observers: Are shown a sample with every setpoint.
        arm: Moves the handle; a person's unless given.
        climbing: Is shown the vehicle after every step of the take-off.

    Attributes:
        vehicle: The simulated vehicle, for who wants the truth.
        link: Between the sites.
        local: The operator's side.

    Raises:
        ScenarioError: The airframe cannot be used, or an obstacle stands on the pad.
        TakeOffError: The vehicle does not come to hover.
    """

    def __init__(
        self,
        setup: Setup,
        hand: HandMaker,
        observers: tuple[Observer, ...] = (),
        arm: Mover | None = None,
        climbing: Callable[[Simulator], None] = _unseen,
    ) -> None:
        settings = setup.settings
        device = handle_at(setup.rate)
        vehicle = self.vehicle = build(setup.scenario, seed=setup.seed)
        link = self.link = Link(setup.up, setup.down, setup.seed)
        self._remote = RemoteSite(vehicle, link, settings.rates.telemetry)
        self._remote.take_off(setup.altitude, climbing)
        pilot = Pilot(settings, device, known(vehicle, setup), setup.controller)
        self.local = LocalSite(
            pilot=pilot,
            hand=hand(RateMapping(settings.mapping, device.workspace), device),
            link=link,
            device=device,
            settings=settings,
            operator=setup.operator or Steady(beginning(settings).choices),
            start_t=vehicle.t,
            arm=arm,
            hesitates=setup.hesitates,
        )
        self._observers = observers
        self._ticks_between = round(setup.rate) // STEPS_HZ - 1

    @property
    def t(self) -> float:
        """Since take-off, s."""
        return self.local.t - (self.vehicle.autopilot.took_off_t or 0.0)

    def fly(self, seconds: float, finished: Callable[[], bool] = lambda: False) -> None:
        """Fly on for so many virtual seconds, or until a sample after which `finished` says so."""
        tick, step, between = self.local.tick, self._remote.step, range(self._ticks_between)
        for _ in range(round(seconds / STEP_S)):
            due = tick()
            if due:
                self._show()
            step()
            for _ in between:
                tick()
            if due and finished():
                return

    def _show(self) -> None:
        if not self._observers:
            return
        local, vehicle = self.local, self.vehicle
        x, y, z, _ = vehicle.p
        distance, _ = vehicle.world.clearance((x, y, z))
        sample = Sample(
            self.t,
            local.coupling.phase,
            local.handle,
            local.outputs,
            vehicle.p,
            vehicle.v,
            vehicle.wind,
            distance - vehicle.airframe.radius,
            local.state_age,
            local.end.round_trip,
        )
        for observer in self._observers:
            observer(sample)


def known(vehicle: Simulator, setup: Setup) -> Surroundings:
    """Return what the pilot may know of a simulated vehicle and its world."""
    airframe = vehicle.airframe
    scenario = setup.scenario
    chi = airframe.chi if scenario.vehicle.model == "dynamic" else None
    return Surroundings(scenario.obstacle, airframe.radius, chi, setup.fence, setup.way, setup.guidance)
