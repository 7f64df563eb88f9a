"""The hand that flies an excitation: it holds the handle where p_h moves as planned."""

from __future__ import annotations

import math
from collections.abc import Callable

from drivers.device import ZERO3
from drivers.stick import StickSender
from groundstation.config import Settings
from groundstation.console import Snapshot
from groundstation.frames import Vector4, wrap
from groundstation.identification.excitation import Excitation
from groundstation.messages import PilotState
from groundstation.pilot.controller import vehicle_rates, world_rates
from groundstation.pilot.mapping import Displacement, RateMapping
from groundstation.pilot.reference import bounded

# A handle that is moved 50 times a second leads p_h past the plan by and by; it is led back, 1/s.
_BACK = 0.5
# At the end: what is left of the motion dies out, s.
_SETTLE_S = 2.0
_GRACE_S = 15.0


class ExcitingHand:
    """Moves p_h along an excitation's way, on the axes the vehicle has at the start.

    Args:
        excitation: What is flown.
        settings: Those of the flight.
        sender: Takes the wish to the scripted hand.
        limit: How far from its start the vehicle may come, m; further, and the flight ends.
        clock: Monotonic seconds.

    Attributes:
        furthest: How far it came, m.
        hesitates_s: Infinite: an excitation that is broken off is no good.
    """

    def __init__(
        self,
        excitation: Excitation,
        settings: Settings,
        sender: StickSender,
        limit: float,
        clock: Callable[[], float],
    ) -> None:
        self._excitation = excitation
        self._settings = bounded(settings.mapping, settings.limits)
        self._sender = sender
        self._limit = limit
        self._clock = clock
        self._mapping: RateMapping | None = None
        self._workspace = 0.0
        self._began: float | None = None
        self._start: Vector4 = (0.0, 0.0, 0.0, 0.0)
        self._away = 0.0
        self.furthest = 0.0
        self.hesitates_s = math.inf
        self.patience_s = excitation.duration + _SETTLE_S + _GRACE_S

    def move(self, view: Snapshot, *, flying: bool) -> None:
        """Hold the handle where the plan has it; at the centre while there is nothing to fly."""
        device, pilot, state = view.device, view.pilot, view.vehicle
        if device and device.workspace != self._workspace:
            self._workspace = device.workspace
            self._mapping = RateMapping(self._settings, device.workspace)
        wanted = Displacement(ZERO3, 0.0)
        if flying and self._mapping and pilot and state and state.valid:
            if self._began is None:
                self._began, self._start = view.t, _four(pilot.p_h)
            rate = self._rate(view.t - self._began, pilot)
            wanted = self._mapping.displacement_for(rate, state.position[3])
            self._away = math.dist(tuple(state.position)[:3], self._start[:3])
            self.furthest = max(self.furthest, self._away)
        self._sender.send(wanted.position, wanted.yaw, 0, self._clock())

    def finished(self, view: Snapshot) -> bool:
        """Say whether all of it is flown, and has settled."""
        return self._began is not None and view.t - self._began > self._excitation.duration + _SETTLE_S

    def fault(self, view: Snapshot) -> str:  # noqa: ARG002
        """Say that the vehicle has come further than it may, if it has."""
        if self._away <= self._limit:
            return ""
        return f"it came {self._away:.1f} m from its start, and {self._limit:.1f} m is the most it may"

    def told(self, view: Snapshot) -> str:
        """Return how much is flown, and where it is."""
        done = 0.0 if self._began is None else min(view.t - self._began, self._excitation.duration)
        return f"{done:.0f} of {self._excitation.duration:.0f} s, {self._away:.2f} m from its start"

    def _rate(self, t: float, pilot: PilotState) -> Vector4:
        """Return the ṗ_h that is wanted, world: the plan's, and back to the plan's way."""
        way, velocity = self._excitation.at(t)
        x, y, z, yaw = self._start
        p_h = _four(pilot.p_h)
        moved = vehicle_rates((p_h[0] - x, p_h[1] - y, p_h[2] - z, wrap(p_h[3] - yaw)), yaw)
        a, b, c, d = (
            rate + _BACK * (wanted - is_) for rate, wanted, is_ in zip(velocity, way, moved, strict=True)
        )
        return world_rates((a, b, c, d), yaw)


def _four(values: object) -> Vector4:
    a, b, c, d = values  # pyright: ignore[reportGeneralTypeIssues] - a ctypes array
    return a, b, c, d
