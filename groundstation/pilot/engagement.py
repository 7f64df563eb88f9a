"""When the hand is coupled to the vehicle, and what ends it: a pure state machine.

    DISENGAGED ──operator's act, all conditions met──► ENGAGING ──vehicle confirms offboard──► ENGAGED
        ▲                                                 │                                      │
        └── operator's act, any condition lost, timeout ──┴──────────────────────────────────────┘

It never engages by itself and never seizes back what another took: every coupling begins with an act. Which
conditions there are, and what each does, is in the table of `groundstation.failsafe`.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot
from typing import NamedTuple

from drivers.device import DeviceInfo, HandleState
from groundstation.conditions import Conditions
from groundstation.config import Safety
from groundstation.failsafe import STREAMING, Action, Row, Who, first, rows
from groundstation.messages import FlightMode, Phase, Severity, Stream

CENTRED = 0.15
# In metres, m/s, radians: nothing here is a million of anything. Comparisons are false for NaN.
_ABSURD = 1e6
# What ends a coupling, and what besides forbids to begin one.
_ENDING = rows(Who.PILOT, Action.CUT, Action.FADE)
_REFUSING = (*_ENDING, *rows(Who.PILOT, Action.REFUSE))


class Engagement(NamedTuple):
    """The state between ticks.

    Attributes:
        phase: How far the hand is coupled.
        since: When the phase began, monotonic s.
        mode: The vehicle's mode when the operator engaged.
        boots: The vehicle's reboots by then.
        streamed: The link has been seen streaming since.
    """

    phase: Phase = Phase.DISENGAGED
    since: float = 0.0
    mode: FlightMode = FlightMode.UNKNOWN
    boots: int = 0
    streamed: bool = False


class Ending(NamedTuple):
    """Why a coupling ended.

    Attributes:
        words: For the operator.
        severity: An end that was asked for is no alarm.
        cut: The force must be gone at once, as hand or servo cannot be trusted; else it fades.
    """

    words: str
    severity: Severity = Severity.ALARM
    cut: bool = False


def believable(numbers: Iterable[float]) -> bool:
    """Say whether every number is one that a device or a vehicle can mean: finite, and not absurdly large."""
    return all(-_ABSURD < number < _ABSURD for number in numbers)


def centred(handle: HandleState, info: DeviceInfo, yaw_range: float) -> bool:
    """Say whether the handle is close enough to its centre to engage without a start."""
    return hypot(*handle.position) <= CENTRED * info.workspace and abs(handle.yaw) <= CENTRED * yaw_range


def refusal(c: Conditions, safety: Safety) -> str:
    """Return why the hand cannot be coupled now, or "" where it can."""
    row = first(_REFUSING, c, safety)
    return row.say(c) if row else ""


def engage(engagement: Engagement, c: Conditions, safety: Safety) -> tuple[Engagement, str]:
    """Begin to couple, as the operator asks for.

    Returns:
        The new state, and why it was refused, or "".
    """
    if engagement.phase is not Phase.DISENGAGED:
        return engagement, ""
    if words := refusal(c, safety):
        return engagement, words
    return Engagement(Phase.ENGAGING, c.t, c.mode, c.boots), ""


def disengage(engagement: Engagement, words: str) -> tuple[Engagement, Ending | None]:
    """End the coupling, if there is one, as the operator asks for."""
    if engagement.phase is Phase.DISENGAGED:
        return engagement, None
    return Engagement(), Ending(words, Severity.INFO)


def advance(engagement: Engagement, c: Conditions, safety: Safety) -> tuple[Engagement, Ending | None]:
    """Go on for one tick: confirm, keep, or end a coupling."""
    if engagement.phase is Phase.DISENGAGED:
        return engagement, None
    seen = _since(engagement, c)
    if row := first(_ENDING, seen, safety):
        return Engagement(), _ending(row, seen)
    if not engagement.streamed and c.streaming in STREAMING:
        engagement = engagement._replace(streamed=True)
    if engagement.phase is Phase.ENGAGING and _confirmed(c):
        engagement = engagement._replace(phase=Phase.ENGAGED, since=c.t)
    return engagement, None


def _since(engagement: Engagement, c: Conditions) -> Conditions:
    """Return conditions with what has been since the operator engaged."""
    return c._replace(
        phase=engagement.phase,
        rebooted=c.boots != engagement.boots,
        engaged_in=engagement.mode,
        streamed=engagement.streamed,
        waited=c.t - engagement.since,
    )


def _ending(row: Row, c: Conditions) -> Ending:
    return Ending(row.say(c), row.severity, cut=row.action is Action.CUT)


def _confirmed(c: Conditions) -> bool:
    return c.mode is FlightMode.OFFBOARD and c.streaming is Stream.FLYING
