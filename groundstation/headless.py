"""A flight without a screen: a hand of the program's own flies through the very processes a person would.

Whose hand it is, the flight does not know. A mission's is a simulated operator's (`groundstation.headless_hand`):
they look at the vehicle and decide where it should go; what they want of it is turned back through the rate mapping
into where the hand should be, and the arm (`drivers.scripted`) takes it there.
"""

from __future__ import annotations

import math
import sys
import time
from enum import Enum
from typing import Protocol

from drivers.stick import StickSender
from groundstation.bus import Bus
from groundstation.console import Console, Snapshot
from groundstation.errors import InputError
from groundstation.headless_hand import OperatorHand
from groundstation.messages import CommandAnswer, CommandKind, FlightMode, Health, Phase, VehicleStatus
from groundstation.processes import Supervisor
from groundstation.progress.keeper import Keeper
from groundstation.run import Run
from groundstation.training.director import Director, Stage
from groundstation.training.follower import MissionFollower
from groundstation.training.mission import Mission
from groundstation.training.summary import Narrator, summarise
from groundstation.vehicle.profiles import LEFT_BY_LANDING

TURN_S = 0.02
_STEP_S = 20.0
_RETRY_S = 1.0
# A link or a handle that a mission takes away is back after a minute, and then the vehicle must be seen to hold, s.
_OUTAGE_S = 80.0


class Step(Enum):
    """What the flight is at; each is left when the vehicle shows that it is done."""

    CONNECT = "connecting"
    ARM = "arming"
    TAKEOFF = "taking off"
    ENGAGE = "engaging"
    FLY = "flying"
    HOLD = "holding"
    DISENGAGE = "letting go"
    LAND = "landing"
    DONE = "done"


# Nobody flies into HOLD: it is where the vehicle waits until a hand that was uncoupled takes it back.
_ORDER = tuple(step for step in Step if step is not Step.HOLD)
_COMMANDS = {
    Step.ARM: CommandKind.ARM,
    Step.TAKEOFF: CommandKind.TAKEOFF,
    Step.ENGAGE: CommandKind.ENGAGE,
    Step.HOLD: CommandKind.HOLD,
    Step.DISENGAGE: CommandKind.DISENGAGE,
    Step.LAND: CommandKind.LAND,
}


_DOWN = frozenset({Stage.DONE, Stage.WAITING})
# Where a step that is given up leads: whatever may be in the air is brought down.
_WAY_DOWN = {
    Step.TAKEOFF: Step.LAND,
    Step.ENGAGE: Step.LAND,
    Step.FLY: Step.DISENGAGE,
    Step.HOLD: Step.LAND,
    Step.DISENGAGE: Step.LAND,
}


class Hand(Protocol):
    """Moves the handle, and knows when it is through."""

    @property
    def patience_s(self) -> float:
        """Return how long it may take, s."""
        ...

    @property
    def hesitates_s(self) -> float:
        """Return how long after it was uncoupled it takes the vehicle back, s; infinite: it never does."""
        ...

    def move(self, view: Snapshot, *, flying: bool) -> None:
        """Hold the handle where it should be; at the centre while there is nothing to fly."""
        ...

    def finished(self, view: Snapshot) -> bool:
        """Say whether what was to be flown is flown."""
        ...

    def fault(self, view: Snapshot) -> str:
        """Return in words why the flight must end, or ""."""
        ...

    def told(self, view: Snapshot) -> str:
        """Return how it is going, for people."""
        ...


class HeadlessFlight:
    """Flies from the ground to the ground; `turn` is one pass, to be called every `TURN_S`.

    Args:
        console: The operator's side of the bus.
        director: Follows the mission.
        hand: Who flies.

    Attributes:
        step: What the flight is at.
        failure: Why it was given up, in words; empty while all is well.
    """

    def __init__(self, console: Console, director: Director, hand: Hand) -> None:
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
            self._go_on(view, Step.ENGAGE if self.step is Step.HOLD else _ORDER[_ORDER.index(self.step) + 1])
        elif self.step is Step.FLY and not self.failure and self._uncoupled(view):
            self._go_on(view, Step.HOLD)
            self._next_try = view.t + self._hand.hesitates_s
        elif view.t - self._since > self._patience():
            self._give_up(view)
        elif self.step in _COMMANDS and view.t >= self._next_try:
            self._next_try = view.t + _RETRY_S
            self._console.command(_COMMANDS[self.step])

    def come_down(self, why: str) -> None:
        """Give the flight up: let go of the vehicle, which holds, and land it where it is in the air."""
        self.failure = self.failure or why
        if self.step not in _WAY_DOWN.values():
            self._come_down()

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
            return bool(status.connected) and _can_be_armed(status) and view.servo is not None
        if self.step is Step.ARM:
            return bool(status.armed)
        if self.step is Step.TAKEOFF:
            return self._director.stage not in {Stage.WAITING, Stage.TAKING_OFF}
        if self.step is Step.ENGAGE:
            return pilot is not None and pilot.phase == Phase.ENGAGED
        if self.step is Step.FLY:
            return self._flown(view)
        if self.step is Step.HOLD:
            return status.mode == FlightMode.HOLD and view.t >= self._next_try
        if self.step is Step.DISENGAGE:
            return pilot is not None and pilot.phase == Phase.DISENGAGED
        # The director sees the landing with the next position, which may be later than the status.
        return self.step is Step.LAND and not status.armed and self._director.stage in _DOWN

    def _flown(self, view: Snapshot) -> bool:
        if self._hand.finished(view):
            return True
        if view.pilot and self._uncoupled(view) and math.isinf(self._hand.hesitates_s):
            self.failure = f"the hand was uncoupled: {view.pilot.reason.decode(errors='replace')}"
        else:
            self.failure = self._hand.fault(view)
        return bool(self.failure)

    def _uncoupled(self, view: Snapshot) -> bool:
        return view.pilot is not None and view.pilot.phase == Phase.DISENGAGED

    def _go_on(self, view: Snapshot, step: Step) -> None:
        self.step = step
        self._since, self._next_try, self._refusal = view.t, 0.0, ""

    def _patience(self) -> float:
        if self.step is Step.HOLD:
            return _OUTAGE_S + self._hand.hesitates_s
        return self._hand.patience_s if self.step is Step.FLY else _STEP_S + 10.0

    def _give_up(self, view: Snapshot) -> None:
        """Say why, and come down if in the air."""
        why = f" ({self._refusal.rstrip('.')})" if self._refusal else ""
        if self.step is Step.CONNECT:
            why = f" ({_missing(view)})"
        self.failure = self.failure or f"{self.step.value} took too long{why}"
        self._come_down()

    def _come_down(self) -> None:
        """Go on with the step that leads down from the present one."""
        self.step = _WAY_DOWN.get(self.step, Step.DONE)
        self._since, self._next_try = None, 0.0


def _missing(view: Snapshot) -> str:
    """Say what a connection waits for."""
    if view.status is None or not view.status.heard_t:
        return "nothing was heard from a vehicle; check that it is on and the URL is its"
    if not view.status.connected:
        return "frames come, but no autopilot's heartbeat among them"
    if not _can_be_armed(view.status):
        return "the vehicle says it cannot be armed; see its messages"
    return "the servo has not started"


def _can_be_armed(status: VehicleStatus) -> bool:
    """Say whether it can be armed as it is, or by way of Hold."""
    return bool(status.health & Health.ARMABLE) or status.mode in LEFT_BY_LANDING


def fly_headless(
    run: Run, bus: Bus, supervisor: Supervisor, *, as_json: bool, operator: str, seed: int
) -> int:
    """Fly the run's mission, tell how it goes on stderr and how it went on stdout; return the exit code."""
    mission = run.mission
    if mission is None:
        raise InputError("--headless needs a --mission to fly.")
    outing = Outing(run, mission, bus, supervisor)
    hand = OperatorHand(
        outing.director, run.settings, outing.sender, time.monotonic, operator=operator, seed=seed
    )
    flight = outing.flight(hand)
    view = outing.fly(flight, hand)
    supervisor.stop()
    outing.follower.finish()
    for words in Keeper(run, outing.follower.attempts).close():
        sys.stderr.write(f"groundstation: {words}\n")
    return summarise(run, outing.follower.measurer, view.servo, flight.failure, as_json=as_json)


class Outing:
    """All that a flight without a screen needs, and the loop that flies it.

    Args:
        run: The run.
        mission: What is flown, for the director.
        bus: The supervisor's place on it.
        supervisor: Of the run's processes.

    Attributes:
        follower: Measures the flight.
        director: Follows the mission.
        sender: Moves the scripted hand.
    """

    def __init__(self, run: Run, mission: Mission, bus: Bus, supervisor: Supervisor) -> None:
        self._bus, self._supervisor = bus, supervisor
        self._console = Console(bus, "headless")
        self.follower = MissionFollower(mission, bus, run.par)
        self.director = self.follower.director
        self.sender = StickSender(str(run.hand))

    def flight(self, hand: Hand) -> HeadlessFlight:
        """Return a flight with this hand."""
        return HeadlessFlight(self._console, self.director, hand)

    def fly(self, flight: HeadlessFlight, hand: Hand) -> Snapshot:
        """Fly until it is done, telling how it goes on stderr; return what was seen last."""
        narrator = Narrator(sys.stderr)
        view = self._console.snapshot()
        try:
            while flight.step is not Step.DONE:
                for sentence in self._supervisor.poll():
                    flight.abort(sentence)
                view = self._console.snapshot()
                self.follower.look(view)
                flight.turn(view)
                narrator.tell(flight.step.value, hand.told(view), view)
                self._bus.heartbeat()
                time.sleep(TURN_S)
        finally:
            narrator.close()
        return view
