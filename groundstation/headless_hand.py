"""The hand of a simulated operator in a live flight: from what a screen would show to where the handle should be."""

from __future__ import annotations

import math
from collections.abc import Callable

from drivers.device import ZERO3
from drivers.stick import StickSender
from groundstation.config import Settings
from groundstation.console import Snapshot
from groundstation.operators.pupil import Pupil
from groundstation.pilot.mapping import Displacement, RateMapping
from groundstation.training.director import Director
from groundstation.training.events import DeviceLoss, GpsLoss, LinkLoss
from groundstation.training.summary import figures_of
from sim.people import PEOPLE

# Beyond the mission's own limit the flight is given up and landed, s.
_GRACE_S = 15.0


class OperatorHand:
    """A simulated operator's head; the arm is the scripted device's (`drivers.scripted`).

    Args:
        director: Follows the mission, and knows what is next.
        settings: Those of the flight.
        sender: Takes the wish to the scripted hand.
        clock: Monotonic seconds.
        operator: Who flies, by a name in `sim.people`.
        seed: Of the operator's noise.

    Attributes:
        patience_s: How long it may take, s.
        hesitates_s: How long before the vehicle is taken back when the hand was uncoupled, s; infinite where it is
            not the mission that uncouples it: then somebody else took the vehicle, and shall have it.
    """

    def __init__(
        self,
        director: Director,
        settings: Settings,
        sender: StickSender,
        clock: Callable[[], float],
        *,
        operator: str,
        seed: int,
    ) -> None:
        mission, person = director.mission, PEOPLE[operator]
        self._director = director
        self._pupil = Pupil(mission, person, seed)
        self._settings = settings.mapping
        self._mapping: RateMapping | None = None
        self._workspace = 0.0
        self._sender = sender
        self._clock = clock
        self.patience_s = mission.criteria.time_limit_s + _GRACE_S
        uncouples = any(isinstance(event, DeviceLoss | GpsLoss | LinkLoss) for event in mission.event)
        self.hesitates_s = person.recovers if uncouples else math.inf

    def move(self, view: Snapshot, *, flying: bool) -> None:
        """Hold the handle where the operator wants it; at the centre while there is nothing to fly."""
        wanted = Displacement(ZERO3, 0.0)
        state, device, status = view.vehicle, view.device, view.status
        if device and device.workspace != self._workspace:
            self._workspace = device.workspace
            self._mapping = RateMapping(self._settings, device.workspace)
        if flying and self._mapping and status and state and state.valid:
            x, y, z, yaw = state.position
            vx, vy, vz, _ = state.velocity
            wish = self._pupil.decide(view.t, (x, y, z, yaw), (vx, vy, vz), self._director, status.rtt)
            wanted = self._mapping.displacement_for(wish, yaw)
        self._sender.send(wanted.position, wanted.yaw, 0, self._clock())

    def finished(self, view: Snapshot) -> bool:  # noqa: ARG002
        """Say whether nothing is left but to land."""
        return self._pupil.through

    def fault(self, view: Snapshot) -> str:  # noqa: ARG002
        """Return "": the mission's own limits end it."""
        return ""

    def told(self, view: Snapshot) -> str:
        """Return the mission's figures."""
        return figures_of(self._director, view)
