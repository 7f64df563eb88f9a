"""What others may read of an autopilot: mode, home, flags, plans, notices."""

from __future__ import annotations

from collections import deque

from sim.autopilot.failsafe import Act
from sim.autopilot.guard import Guard
from sim.autopilot.guidance import Target
from sim.autopilot.modes import Mode
from sim.autopilot.navigator import Navigator
from sim.autopilot.notices import Notice, Notices, Severity
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Plan
from sim.autopilot.watch import Watch
from sim.battery import Battery
from sim.kinematics import Vector4
from sim.models.motion import Attitude


class Instruments:
    """The parts of an autopilot, and what they show.

    Args:
        parameters: What governs it.
        navigator: Steers.
        battery: What it watches.
        attitude: How the vehicle leans.

    Attributes:
        parameters: What governs it.
    """

    def __init__(
        self, parameters: Parameters, navigator: Navigator, battery: Battery, attitude: Attitude
    ) -> None:
        self.parameters = parameters
        self._notices = Notices()
        self._navigator = navigator
        self._watch = Watch(navigator, parameters, battery, attitude, self.say)
        self._guard = Guard(parameters)

    @property
    def mode(self) -> Mode:
        """Who or what steers."""
        return self._navigator.mode

    @property
    def home(self) -> Vector4:
        """Where it returns to: where it was last armed, unless that was set."""
        return self._navigator.flight.home

    @property
    def target(self) -> Target:
        """What it steers to."""
        return self._navigator.setpoint if self.mode is Mode.OFFBOARD else self._navigator.flight.target

    @property
    def landed(self) -> bool:
        """It stands on something."""
        return self._watch.landed

    @property
    def took_off_t(self) -> float | None:
        """When it last left the ground, s, or None."""
        return self._watch.took_off_t

    @property
    def failsafe(self) -> bool:
        """A failsafe acts."""
        return self._guard.act > Act.WARN

    @property
    def streaming(self) -> bool:
        """Setpoints are coming at 2 Hz or more."""
        return self._watch.streaming

    @property
    def position_valid(self) -> bool:
        """It trusts its position."""
        return self._watch.position_valid

    @property
    def has_sticks(self) -> bool:
        """Fresh sticks are there."""
        return self._watch.has_sticks

    @property
    def fence_breach(self) -> str:
        """How the fence is breached, or ""."""
        return self._watch.breach

    @property
    def plan(self) -> Plan:
        """All that is on board."""
        return self._navigator.plan

    @property
    def mission_index(self) -> int:
        """The item being flown, or to begin with."""
        return self._navigator.mission.index

    @property
    def mission_reached(self) -> int:
        """The last item completed, or −1; `mission_reached_count` grows with each."""
        return self._navigator.mission.reached

    @property
    def mission_reached_count(self) -> int:
        """How many items have been completed, jumps counted each time."""
        return self._navigator.mission.reached_count

    @property
    def mission_finished(self) -> bool:
        """The last item is done."""
        return self._navigator.mission.finished

    def mailbox(self) -> deque[Notice]:
        """Return one more mailbox: it gets every notice from now on."""
        return self._notices.mailbox()

    def say(self, severity: Severity, text: str) -> None:
        """Tell everybody something."""
        self._notices.say(severity, text)
