"""A flight without a screen: the scripted hand flies a mission through the very processes a person would.

A simulated operator (`sim.operator`) looks at the vehicle and decides where it should go; what they want of it
is turned back through the rate mapping into where the hand should be, and the arm (`drivers.scripted`) takes it
there.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from enum import Enum
from typing import NamedTuple

from drivers.device import ZERO3
from drivers.stick import StickSender
from groundstation import config
from groundstation.bus import Bus
from groundstation.console import Console, Snapshot
from groundstation.errors import InputError
from groundstation.messages import CommandAnswer, CommandKind, Health, Phase, ServoReport
from groundstation.pilot.mapping import Displacement, RateMapping
from groundstation.processes import Supervisor
from groundstation.run import Run
from groundstation.training.director import Director, Stage
from groundstation.training.follower import MissionFollower
from groundstation.training.mission import Mission
from groundstation.training.summary import Narrator, summarise
from sim.operator import Operator

TURN_S = 0.02
CENTRE = Displacement(ZERO3, 0.0)
_STEP_S = 20.0
_RETRY_S = 1.0
# Beyond the mission's own limit the flight is given up and landed, s.
_GRACE_S = 15.0


class Step(Enum):
    """What the flight is at; each is left when the vehicle shows that it is done."""

    CONNECT = "connecting"
    ARM = "arming"
    TAKEOFF = "taking off"
    ENGAGE = "engaging"
    FLY = "flying"
    DISENGAGE = "letting go"
    LAND = "landing"
    DONE = "done"


_ORDER = tuple(Step)
_COMMANDS = {
    Step.ARM: CommandKind.ARM,
    Step.TAKEOFF: CommandKind.TAKEOFF,
    Step.ENGAGE: CommandKind.ENGAGE,
    Step.DISENGAGE: CommandKind.DISENGAGE,
    Step.LAND: CommandKind.LAND,
}


_DOWN = frozenset({Stage.DONE, Stage.WAITING})
# Where a step that is given up leads: whatever may be in the air is brought down.
_WAY_DOWN = {
    Step.TAKEOFF: Step.LAND,
    Step.ENGAGE: Step.LAND,
    Step.FLY: Step.DISENGAGE,
    Step.DISENGAGE: Step.LAND,
}


class HeadlessFlight:
    """Flies one mission; `turn` is one pass, to be called every `TURN_S`.

    Args:
        mission: What to fly.
        console: The operator's side of the bus.
        director: Follows the mission.
        hand: Who moves the handle.

    Attributes:
        step: What the flight is at.
        failure: Why it was given up, in words; empty while all is well.
    """

    def __init__(self, mission: Mission, console: Console, director: Director, hand: HandleMover) -> None:
        self._mission = mission
        self._console = console
        self._director = director
        self._hand = hand
        self._since: float | None = None
        self._next_try = 0.0
        self._refusal = ""
        self.step = Step.CONNECT
        self.failure = ""

    def turn(self, view: Snapshot) -> None:
        """Look at the newest of everything and do what comes next."""
        if self._since is None:
            self._since = view.t
        self._note_refusals(view.answers)
        self._hand.move(view, flying=self.step is Step.FLY)
        if self._done(view):
            self.step = _ORDER[_ORDER.index(self.step) + 1]
            self._since, self._next_try, self._refusal = view.t, 0.0, ""
        elif view.t - self._since > self._patience():
            self._give_up(view)
        elif self.step in _COMMANDS and view.t >= self._next_try:
            self._next_try = view.t + _RETRY_S
            self._console.command(_COMMANDS[self.step])

    def abort(self, why: str) -> None:
        """Give the flight up: the pilot lets go, the vehicle holds, nothing more is asked of it."""
        self._console.command(CommandKind.DISENGAGE)
        self.failure = self.failure or why
        self.step = Step.DONE

    def _note_refusals(self, answers: tuple[CommandAnswer, ...]) -> None:
        for answer in answers:
            if not answer.ok:
                self._refusal = answer.text.decode(errors="replace")

    def _done(self, view: Snapshot) -> bool:
        """Say whether the vehicle shows that the present step is done."""
        status, pilot = view.status, view.pilot
        if status is None:
            return False
        if self.step is Step.CONNECT:
            return bool(status.connected) and bool(status.health & Health.ARMABLE) and view.servo is not None
        if self.step is Step.ARM:
            return bool(status.armed)
        if self.step is Step.TAKEOFF:
            return self._director.stage not in {Stage.WAITING, Stage.TAKING_OFF}
        if self.step is Step.ENGAGE:
            return pilot is not None and pilot.phase == Phase.ENGAGED
        if self.step is Step.FLY:
            return self._flown(view)
        if self.step is Step.DISENGAGE:
            return pilot is not None and pilot.phase == Phase.DISENGAGED
        # The director sees the landing with the next position, which may be later than the status.
        return self.step is Step.LAND and not status.armed and self._director.stage in _DOWN

    def _flown(self, view: Snapshot) -> bool:
        if self._hand.flown(self._director):
            return True
        if view.pilot is not None and view.pilot.phase == Phase.DISENGAGED:
            self.failure = f"the hand was uncoupled: {view.pilot.reason.decode(errors='replace')}"
            return True
        return False

    def _patience(self) -> float:
        return self._mission.criteria.time_limit_s + _GRACE_S if self.step is Step.FLY else _STEP_S + 10.0

    def _give_up(self, view: Snapshot) -> None:
        """Say why, and come down if in the air."""
        why = f" ({self._refusal.rstrip('.')})" if self._refusal else ""
        if self.step is Step.CONNECT:
            why = f" ({_missing(view)})"
        self.failure = self.failure or f"{self.step.value} took too long{why}"
        self.step = _WAY_DOWN.get(self.step, Step.DONE)
        self._since, self._next_try = view.t, 0.0


def _missing(view: Snapshot) -> str:
    """Say what a connection waits for."""
    if view.status is None or not view.status.heard_t:
        return "nothing was heard from a vehicle; check that it is on and the URL is its"
    if not view.status.connected:
        return "frames come, but no autopilot's heartbeat among them"
    if not view.status.health & Health.ARMABLE:
        return "the vehicle says it cannot be armed; see its messages"
    return "the servo has not started"


class HandleMover:
    """Turns what is wanted of the vehicle into where the handle should be, and tells the scripted hand.

    Args:
        mapping: The mapping the pilot flies with.
        sender: Takes the wish to the scripted hand.
        clock: Monotonic seconds.
    """

    def __init__(self, mapping: config.Mapping, sender: StickSender, clock: Callable[[], float]) -> None:
        self._settings = mapping
        self._mapping: RateMapping | None = None
        self._workspace = 0.0
        self._sender = sender
        self._clock = clock

    def move(self, view: Snapshot, *, flying: bool) -> None:
        """Hold the handle where it is wanted; at the centre while there is nothing to fly."""
        position, twist = CENTRE
        device, state = view.device, view.vehicle
        if device and device.workspace != self._workspace:
            self._workspace = device.workspace
            self._mapping = RateMapping(self._settings, device.workspace)
        if flying and self._mapping and state and state.valid:
            position, twist = self.wish(view, self._mapping)
        self._sender.send(position, twist, 0, self._clock())

    def wish(self, view: Snapshot, mapping: RateMapping) -> Displacement:  # noqa: ARG002 - it wants nothing
        """Return where the handle should be, as the vehicle is seen."""
        return CENTRE

    def flown(self, director: Director) -> bool:
        """Say whether there is nothing more to fly."""
        return director.stage is Stage.RETURNING


class Hand(HandleMover):
    """The simulated operator's head and arm: from what is seen to where the handle should be.

    Args:
        mission: Gives the route and the target.
        mapping: The mapping the pilot flies with.
        sender: Takes the wish to the scripted hand.
        seed: Of the operator's noise.
        clock: Monotonic seconds.
    """

    def __init__(
        self,
        mission: Mission,
        mapping: config.Mapping,
        sender: StickSender,
        seed: int,
        clock: Callable[[], float],
    ) -> None:
        super().__init__(mapping, sender, clock)
        route, target = mission.route, mission.target
        self._operator = Operator(route, target.position, seed=seed) if target else None

    def wish(self, view: Snapshot, mapping: RateMapping) -> Displacement:
        """Return what the operator decides."""
        state = view.vehicle
        if self._operator is None or state is None:
            return CENTRE
        x, y, z, yaw = state.position
        vx, vy, vz, _ = state.velocity
        return mapping.displacement_for(self._operator.decide(view.t, (x, y, z, yaw), (vx, vy, vz)), yaw)


def fly_headless(run: Run, bus: Bus, supervisor: Supervisor, *, as_json: bool, seed: int) -> int:
    """Fly the run's mission, tell how it goes on stderr and how it went on stdout; return the exit code."""
    mission = run.mission
    if mission is None:
        raise InputError("--headless needs a --mission to fly.")
    hand = Hand(mission, run.settings.mapping, StickSender(str(run.hand)), seed, time.monotonic)
    flown = fly_steps(mission, bus, supervisor, hand)
    return summarise(run, flown.director, flown.servo, flown.failure, as_json=as_json)


class Flown(NamedTuple):
    """A headless flight that is over.

    Attributes:
        director: Has followed the mission.
        servo: How well the servo kept its time.
        failure: Why it was given up; "" where it was not.
    """

    director: Director
    servo: ServoReport | None
    failure: str


def fly_steps(mission: Mission, bus: Bus, supervisor: Supervisor, hand: HandleMover) -> Flown:
    """Fly from connecting to landing with a hand, telling on stderr how it goes; the processes are ended."""
    console = Console(bus, "headless")
    follower = MissionFollower(mission, bus)
    director = follower.director
    flight = HeadlessFlight(mission, console, director, hand)
    narrator = Narrator(sys.stderr)
    view = console.snapshot()
    while flight.step is not Step.DONE:
        for sentence in supervisor.poll():
            flight.abort(sentence)
        view = console.snapshot()
        follower.look(view)
        flight.turn(view)
        narrator.tell(flight.step.value, director, view)
        bus.heartbeat()
        time.sleep(TURN_S)
    narrator.close()
    supervisor.stop()
    return Flown(director, view.servo, flight.failure)
