"""When setpoints stream to the vehicle, and what ends it: a pure state machine.

    IDLE ──fresh active setpoint──► STARTING ──heartbeat says offboard──► FLYING
      ▲                                │                                    │
      └── setpoint inactive ── ENDED ◄─┴── any end ◄────────────────────────┘

Setpoints stream for a moment before offboard is asked for: a vehicle denies it that hears none, and the first few may
be lost. What has ended does not resume by itself: it takes an inactive setpoint, hence a fresh act of the operator.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from groundstation.conditions import Conditions
from groundstation.config import Safety
from groundstation.failsafe import BY_FAULT, ENGAGE_TIMEOUT_S, Action, Fault, Row
from groundstation.messages import FlightMode, Stream

LEAD_S = 0.2
_SILENT, _TAKEN = BY_FAULT[Fault.PILOT_SILENT], BY_FAULT[Fault.STREAM_TAKEN]


class Act(IntEnum):
    """What the link must do after a step, besides sending the setpoint."""

    NOTHING = 0
    START = 1
    CLOSE = 2
    CLOSE_AND_HOLD = 3


@dataclass(frozen=True, slots=True)
class Seen:
    """What a step is decided on.

    Attributes:
        now: Monotonic s.
        active: The newest setpoint asks to be flown.
        age: Its age, s; infinite before the first.
        mode: The vehicle's mode as of its last heartbeat.
        mode_t: When that heartbeat came.
    """

    now: float
    active: bool
    age: float
    mode: FlightMode
    mode_t: float


@dataclass(slots=True)
class OffboardStream:
    """Holds the state between steps.

    Args:
        safety: Has the age from which a setpoint is not flown and the pilot counts as silent.
    """

    safety: Safety
    state: Stream = Stream.IDLE
    accepted_t: float | None = None
    _started_t: float = 0.0
    _asked: bool = False

    def step(self, seen: Seen) -> tuple[Act, str]:
        """Advance and return what to do and, when a stream ended against the pilot's wish, why."""
        c = Conditions(mode=seen.mode, streaming=self.state, setpoint_age=seen.age)
        fresh = seen.active and not _SILENT.holds(c, self.safety)
        if self.state is Stream.ENDED:
            if not seen.active:
                self.state = Stream.IDLE
            return Act.NOTHING, ""
        if self.state is Stream.IDLE:
            if not fresh:
                return Act.NOTHING, ""
            self.state, self._started_t, self.accepted_t = Stream.STARTING, seen.now, None
            self._asked = False
            return Act.NOTHING, ""
        if not seen.active:
            return self._end(Act.CLOSE_AND_HOLD)
        if not fresh:
            return self._end_by(_SILENT, c)
        if self.state is Stream.STARTING:
            return self._starting(seen)
        # Someone else flies now: a pilot with a transmitter, another station, a failsafe. Never seize it back.
        return self._end_by(_TAKEN, c) if _TAKEN.holds(c, self.safety) else (Act.NOTHING, "")

    def accepted(self, now: float) -> None:
        """The vehicle acknowledged offboard; only a heartbeat from now on proves it."""
        self.accepted_t = now

    def end(self) -> None:
        """The operator commanded another mode: the stream makes room and sends no hold after it."""
        if self.state in {Stream.STARTING, Stream.FLYING}:
            self.state = Stream.ENDED

    def refused(self, why: str) -> tuple[Act, str]:
        """The vehicle denied offboard."""
        return self._end(Act.CLOSE, f"offboard refused: {why}")

    def unanswered(self) -> tuple[Act, str]:
        """The vehicle did not say whether it went to offboard; it may have."""
        return self._end(Act.CLOSE_AND_HOLD, "the vehicle did not answer to offboard; it holds")

    def interrupted(self, why: str) -> tuple[Act, str]:
        """Nothing can be said of the time that has passed: what streamed ends."""
        if self.state in {Stream.STARTING, Stream.FLYING}:
            return self._end(Act.CLOSE_AND_HOLD, why)
        return Act.NOTHING, ""

    def _starting(self, seen: Seen) -> tuple[Act, str]:
        if not self._asked:
            self._asked = seen.now - self._started_t >= LEAD_S
            return (Act.START if self._asked else Act.NOTHING), ""
        proven = self.accepted_t is not None and seen.mode_t > self.accepted_t
        if proven and seen.mode is FlightMode.OFFBOARD:
            self.state = Stream.FLYING
        elif seen.now - self._started_t > ENGAGE_TIMEOUT_S:
            return self._end(Act.CLOSE_AND_HOLD, "the vehicle did not confirm offboard within 3 s; it holds")
        return Act.NOTHING, ""

    def _end_by(self, row: Row, c: Conditions) -> tuple[Act, str]:
        return self._end(Act.CLOSE_AND_HOLD if row.action is Action.HOLD else Act.CLOSE, row.say(c))

    def _end(self, act: Act, why: str = "") -> tuple[Act, str]:
        self.state = Stream.ENDED
        return act, why
