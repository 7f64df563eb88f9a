"""The local site in virtual time: hand, arm, handle and pilot, tick by tick as in the servo."""

from __future__ import annotations

from dataclasses import replace
from math import inf, sqrt
from typing import Protocol

from drivers.arm import Arm, ArmState, stop
from drivers.device import ZERO3, DeviceInfo, HandleState, Vector3
from drivers.scripted import INFO
from groundstation.config import Settings
from groundstation.evaluation.channel_ends import GroundEnd, Link
from groundstation.evaluation.coupling import Coupling
from groundstation.evaluation.hands import CENTRE, Hand
from groundstation.evaluation.operator import Operator
from groundstation.messages import Phase
from groundstation.pilot.pilot import Inputs, Memory, Pilot

# Of this hand and this handle, always.
_CUT, _HOMED = False, True


def handle_at(rate: float) -> DeviceInfo:
    """Return the scripted hand's handle, served `rate` times a second; the damping of its mechanics stays."""
    return replace(INFO, rate=rate, stiffness_limit=INFO.stiffness_limit * rate / INFO.rate)


class Mover(Protocol):
    """Moves the handle, as `drivers.arm.Arm` does."""

    def step(
        self, state: ArmState, dt: float, intention: Vector3, intended_yaw: float, force: Vector3
    ) -> ArmState:
        """Return the handle `dt` seconds later."""
        ...


class LocalSite:
    """Everything on the operator's side but the screen.

    Args:
        pilot: Steps at the device's rate.
        hand: Where the handle should be.
        link: To the vehicle.
        device: The handle.
        settings: Those of the pilot.
        operator: Couples and chooses.
        start_t: When it begins, s.
        arm: Moves the handle where the hand wants it; a person's unless given.
        hesitates: As `Coupling` has it, s.

    Attributes:
        pilot: As given.
        operator: As given.
        t: Of the tick that comes next, s.
        end: The ground's end of the link.
        coupling: Of hand and vehicle.
        handle: At the last tick.
        outputs: Of the last tick.
        state_age: Age of the vehicle's state then, s.
        strongest: Largest force on the hand so far, N.
        given: Work that the hand has done on the handle so far, J; less than nothing where the hand was moved.
    """

    def __init__(
        self,
        *,
        pilot: Pilot,
        hand: Hand,
        link: Link,
        device: DeviceInfo,
        settings: Settings,
        operator: Operator,
        start_t: float,
        arm: Mover | None = None,
        hesitates: float = 0.0,
    ) -> None:
        self.pilot, self._hand, self.operator = pilot, hand, operator
        self._workspace = device.workspace
        self._arm, self._arm_state = arm or Arm(), ArmState()
        self._wanted = CENTRE
        self._memory = Memory()
        self._dt = 1.0 / device.rate
        self._setpoint_every = max(1, round(device.rate / settings.rates.setpoint))
        self._start_t, self._ticks = start_t, 0
        self.t = start_t
        self.end = GroundEnd(link)
        self.coupling = Coupling(settings, device, self.end, hesitates)
        self.handle = HandleState(ZERO3, ZERO3, 0.0, 0, homed=True, device_time=start_t)
        _, self.outputs = pilot.step(
            self._memory, Inputs(self._dt, self.coupling.phase, _CUT, self.handle, self.end.sample, inf)
        )
        self.state_age = inf
        self.strongest = self.given = 0.0

    def tick(self) -> bool:
        """Run one tick: listen, decide, step the pilot, and let the arm move under the force until the next.

        Returns:
            Whether the hand decided and a setpoint was due at this tick.
        """
        t, dt, end = self.t, self._dt, self.end
        end.listen(t)
        self.state_age = age = t - end.heard_t
        place, speed, yaw, _ = state = self._arm_state
        self.handle = handle = HandleState(place, speed, yaw, 0, _HOMED, t)
        due = self._ticks % self._setpoint_every == 0
        if due:
            self._decide(t)
        phase = self.coupling.phase
        choices = self.operator.choices()
        inputs = Inputs(dt, phase, _CUT, handle, end.sample, age, end.round_trip, end.loss, choices)
        self._memory, outputs = self.pilot.step(self._memory, inputs)
        self.outputs = outputs
        if due and phase is not Phase.DISENGAGED:
            end.give(t, outputs.setpoint)
        (wanted, twist), force = self._wanted, outputs.force
        f, g, h = force
        self._arm_state = moved = stop(self._arm.step(state, dt, wanted, twist, force), self._workspace)
        (x, y, z), (a, b, c) = moved.position, place
        self.given -= f * (x - a) + g * (y - b) + h * (z - c)
        self.strongest = max(self.strongest, sqrt(f * f + g * g + h * h))
        self._ticks += 1
        self.t = self._start_t + self._ticks * dt
        return due

    def _decide(self, t: float) -> None:
        """Look at link and coupling, and at the vehicle while it follows the hand."""
        self.end.measure(t)
        self.coupling.update(t, self.handle, self.outputs.fault, wanted=self.operator.couples())
        engaged = self.coupling.phase is Phase.ENGAGED
        self._wanted = self._hand.decide(t, self.end.sample) if engaged else CENTRE
