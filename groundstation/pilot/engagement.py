"""When the hand is coupled to the vehicle, and what ends it: a pure state machine.

    DISENGAGED ──operator's act, all conditions met──► ENGAGING ──vehicle confirms offboard──► ENGAGED
        ▲                                                 │                                      │
        └── operator's act, any condition lost, timeout ──┴──────────────────────────────────────┘

It never engages by itself and never seizes back what another took: every coupling begins with an act.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot
from typing import NamedTuple

from drivers.device import DeviceInfo, HandleState
from groundstation.config import Safety
from groundstation.messages import FlightMode, Phase, Severity, Stream

ENGAGE_TIMEOUT_S = 3.0
STALL_S = 0.15
CENTRED = 0.15
# In metres, m/s, radians: nothing here is a million of anything. Comparisons are false for NaN.
_ABSURD = 1e6

_STREAMING = frozenset({Stream.STARTING, Stream.FLYING})
# Modes in which a vehicle waits to be flown; a take-off ends in Hold by itself.
_WAITING = frozenset({FlightMode.OFFBOARD, FlightMode.HOLD})


class Conditions(NamedTuple):
    """What coupling depends on, as of one tick.

    Attributes:
        t: Now, monotonic s.
        gap: Since the servo's last tick, s.
        believable: Every number from the vehicle is; those of the handle were judged where it is read.
        present, homed, centred: Of the handle.
        handle_age: Age of the handle's sample, s.
        connected, armed, in_air: Of the vehicle.
        mode: Who steers it.
        streaming: State of the setpoints' stream to it.
        state_age: Age of its state, s; infinite before the first.
        state_valid: It trusts that state itself.
        boots: How often it has rebooted since the servo started.
        link_fault: Why the link is too poor to fly by, in words, or "".
        unsafe: Why the vehicle's own failsafes forbid to couple, in words, or ""; what is coupled stays so.
    """

    t: float
    gap: float
    believable: bool
    present: bool
    homed: bool
    centred: bool
    handle_age: float
    connected: bool
    armed: bool
    in_air: bool
    mode: FlightMode
    streaming: Stream
    state_age: float
    state_valid: bool
    boots: int
    link_fault: str = ""
    unsafe: str = ""


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
    words = hand_fault(c, safety) or vehicle_fault(c, safety) or c.unsafe
    if words:
        return words
    if c.streaming in _STREAMING:
        return "the link is still ending the last stream of setpoints; engage again"
    return "" if c.centred else "the handle is not in its centre; bring it there and engage again"


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
    if words := hand_fault(c, safety):
        return Engagement(), Ending(words, cut=True)
    words = "the vehicle has rebooted" if c.boots != engagement.boots else vehicle_fault(c, safety)
    words = words or _stream_fault(engagement, c)
    if words:
        return Engagement(), Ending(words)
    if not engagement.streamed and c.streaming in _STREAMING:
        engagement = engagement._replace(streamed=True)
    if engagement.phase is Phase.ENGAGING and _confirmed(c):
        engagement = engagement._replace(phase=Phase.ENGAGED, since=c.t)
    return engagement, None


def hand_fault(c: Conditions, safety: Safety) -> str:
    """Return what is wrong on the hand's side, or ""."""
    if not c.present:
        return "there is no haptic device; see that it is plugged in and switched on"
    if not c.homed:
        return "the handle is not homed; move it through its range until it is"
    if not c.believable:
        return "the vehicle gave a number that cannot be"
    if not c.handle_age <= safety.handle_stale_s:
        return f"the handle's sample is {c.handle_age:.2f} s old"
    if not c.gap <= STALL_S:
        return f"the servo stood still for {c.gap:.2f} s"
    return ""


def vehicle_fault(c: Conditions, safety: Safety) -> str:
    """Return what is wrong on the vehicle's side, or ""."""
    if not c.connected:
        return "the vehicle is not heard; see to the link"
    if not c.state_age <= safety.state_stale_s:
        return (
            f"the vehicle's position is {c.state_age:.1f} s old"
            if c.state_age < 1e6
            else ("the vehicle has not told its position")
        )
    if c.link_fault:
        return c.link_fault
    if not c.state_valid:
        return "the vehicle does not trust its own position"
    if not c.armed:
        return "the vehicle is not armed"
    if not c.in_air:
        return "the vehicle is on the ground; take off first"
    return ""


def _stream_fault(engagement: Engagement, c: Conditions) -> str:
    """Return what is wrong with the way from the setpoint to the vehicle, or ""."""
    if engagement.phase is Phase.ENGAGED and c.mode is not FlightMode.OFFBOARD:
        return f"the vehicle went to {c.mode.name} by itself or by another"
    if c.mode is not engagement.mode and c.mode not in _WAITING:
        return f"the vehicle went to {c.mode.name} meanwhile"
    if engagement.streamed and c.streaming not in _STREAMING:
        return "the link stopped passing setpoints"
    if engagement.phase is Phase.ENGAGING and c.t - engagement.since > ENGAGE_TIMEOUT_S:
        return f"the vehicle did not confirm Offboard within {ENGAGE_TIMEOUT_S:.0f} s"
    return ""


def _confirmed(c: Conditions) -> bool:
    return c.mode is FlightMode.OFFBOARD and c.streaming is Stream.FLYING
