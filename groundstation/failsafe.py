"""What can go wrong and what is done about it: condition → action → words, in one table. Pure.

Whoever acts looks up here what is so and what to do: the pilot's engagement, the link's stream of setpoints, the
supervisor of processes, the recorder, the screen. `docs/operating.md` shows the table.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from math import inf

from groundstation.conditions import Conditions
from groundstation.config import Safety
from groundstation.messages import FlightMode, Phase, Severity, Stream

ENGAGE_TIMEOUT_S = 3.0
STALL_S = 0.15
# A vehicle this much over its limits, in share and in m/s, is not one that the wind pushes a little.
OVERSPEED, OVERSPEED_M_S = 1.5, 1.0
# Silence from which the link counts as lost; PX4's own loss of setpoints (COM_OF_LOSS_T) is 1 s.
LINK_LOST_S = 2.0
BATTERY_LOW, BATTERY_EMPTY = 0.30, 0.15
# Ticks of lateness, 99th percentile: the servo is overrun.
OVERRUN_TICKS = 5.0
STREAMING = frozenset({Stream.STARTING, Stream.FLYING})
# Modes in which a vehicle waits to be flown; a take-off ends in Hold by itself.
_WAITING = frozenset({FlightMode.OFFBOARD, FlightMode.HOLD})


class Who(StrEnum):
    """Who sees it and acts."""

    PILOT = "pilot"
    LINK = "link"
    SUPERVISOR = "supervisor"
    RECORDER = "recorder"
    SCREEN = "screen"
    ALL = "every process"


class Action(StrEnum):
    """What is done, as the documentation says it."""

    REFUSE = "Engage is refused"
    CUT = "hand uncoupled, its force gone at once; the vehicle holds"
    FADE = "hand uncoupled, its force fades within 80 ms; the vehicle holds"
    EASE = "the force fades; gains and speed fall as the link worsens"
    BOUND = "the velocity asked for is cut down to what is safe"
    HOLD = "the gate shuts, the vehicle is told to hold"
    GIVE_WAY = "the gate shuts, nothing is sent against who flies"
    RELEASE = "the pilot lets go, the vehicle holds; without pilot or link their other end does it"
    END = "the pilot ends without force, the link tells the vehicle to hold, both end"
    TELL = "told"


class Fault(StrEnum):
    """What can go wrong."""

    DEVICE_LOST = "device lost"
    NOT_HOMED = "handle not homed"
    SQUEEZED = "enable control squeezed through"
    NOT_ENABLED = "enable control let go"
    UNBELIEVABLE = "state is not a number, or cannot be"
    HANDLE_STALE = "handle stale"
    SERVO_STALLED = "servo stood still"
    REBOOTED = "vehicle rebooted"
    LINK_CUT = "vehicle not heard"
    STATE_UNKNOWN = "no state yet"
    STATE_STALE = "state stale"
    LINK_POOR = "link too poor"
    UNTRUSTED = "estimate invalid"
    DISARMED = "vehicle disarmed"
    LANDED = "vehicle on the ground"
    OVERSPEED = "overspeed"
    MODE_TAKEN = "mode changed by others"
    MODE_MEANWHILE = "mode changed while engaging"
    STREAM_STOPPED = "stream of setpoints ended"
    UNCONFIRMED = "offboard not confirmed"
    UNSAFE = "dangerous or unread parameter"
    STREAM_ENDING = "last stream still ending"
    NOT_CENTRED = "handle not centred"
    STATE_LATE = "link late"
    OBSTACLE = "obstacle near"
    FENCE = "fence, floor or ceiling near"
    PILOT_SILENT = "pilot silent"
    STREAM_TAKEN = "mode changed by others, seen by the link"
    LINK_SILENT = "silence of the vehicle"
    LINK_LOST = "link lost"
    PILOT_DEAD = "pilot dead"
    LINK_DEAD = "link dead"
    RECORDER_DEAD = "recorder dead"
    SIM_DEAD = "simulated vehicle dead"
    PROCESS_DEAD = "another process dead"
    SCREEN_DEAD = "screen dead"
    PROCESS_STALLED = "process stalled"
    BATTERY_LOW = "battery low"
    BATTERY_EMPTY = "battery nearly empty"
    SERVO_OVERRUN = "servo overrun"
    DISK_LOW = "disk nearly full"
    DISK_FULL = "disk full, or folder read-only"


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the table.

    Attributes:
        fault: What is wrong.
        who: Who sees it and acts.
        when: The condition, for people.
        holds: The condition.
        action: What is done.
        words: What is said; names in braces are of `Conditions`.
        severity: Of what is said.
    """

    fault: Fault
    who: Who
    when: str
    holds: Callable[[Conditions, Safety], bool]
    action: Action
    words: str
    severity: Severity = Severity.ALARM

    def say(self, c: Conditions) -> str:
        """Return the words with the figures in them."""
        return self.words.format(c=c)


def late(state_age: float, safety: Safety) -> bool:
    """Say whether a state of this age, s, gives no force any more."""
    return not state_age <= safety.force_stale_s


def _too_fast(speed: float, limit: float) -> bool:
    return speed > OVERSPEED * limit + OVERSPEED_M_S


_F, _A, _W = Fault, Action, Who
_INFO, _WARNING = Severity.INFO, Severity.WARNING

TABLE: tuple[Row, ...] = (
    Row(_F.DEVICE_LOST, _W.PILOT, "the device cannot be read", lambda c, _: not c.present, _A.CUT,
        "there is no haptic device; see that it is plugged in and switched on"),
    Row(_F.NOT_HOMED, _W.PILOT, "the device does not know where it is", lambda c, _: not c.homed, _A.CUT,
        "the handle is not homed; move it through its range until it is"),
    Row(_F.SQUEEZED, _W.PILOT, "`buttons.panic` is pressed", lambda c, _: c.squeezed, _A.CUT,
        "the enable control is squeezed through; let go, then hold it lightly"),
    Row(_F.NOT_ENABLED, _W.PILOT, "`buttons.enable` is not held, where there is one", lambda c, _: not c.enabled,
        _A.CUT, "the enable control is not held", _WARNING),
    Row(_F.UNBELIEVABLE, _W.PILOT, "a number of the vehicle's is not finite, or beyond ±10⁶",
        lambda c, _: not c.believable, _A.CUT, "the vehicle gave a number that cannot be"),
    Row(_F.HANDLE_STALE, _W.PILOT, "sample older than `handle_stale_s` (0.1 s)",
        lambda c, s: not c.handle_age <= s.handle_stale_s, _A.CUT, "the handle's sample is {c.handle_age:.2f} s old"),
    Row(_F.SERVO_STALLED, _W.PILOT, "more than 0.15 s between two ticks", lambda c, _: not c.gap <= STALL_S, _A.CUT,
        "the servo stood still for {c.gap:.2f} s"),
    Row(_F.REBOOTED, _W.PILOT, "its clock goes back by more than 1 s", lambda c, _: c.rebooted, _A.FADE,
        "the vehicle has rebooted"),
    Row(_F.LINK_CUT, _W.PILOT, "no heartbeat for 3 s", lambda c, _: not c.connected, _A.FADE,
        "the vehicle is not heard; see to the link"),
    Row(_F.STATE_UNKNOWN, _W.PILOT, "no position has come", lambda c, _: c.state_age == inf, _A.FADE,
        "the vehicle has not told its position"),
    Row(_F.STATE_STALE, _W.PILOT, "position older than `state_stale_s` (0.5 s)",
        lambda c, s: not c.state_age <= s.state_stale_s, _A.FADE,
        "the vehicle's position is {c.state_age:.1f} s old"),
    Row(_F.LINK_POOR, _W.PILOT, "round trip or loss beyond `link.hold_delay_s` (1.2 s), `link.hold_loss` (70 %)",
        lambda c, _: bool(c.link_fault), _A.FADE, "{c.link_fault}"),
    Row(_F.UNTRUSTED, _W.PILOT, "the vehicle does not trust its position, or has no heading",
        lambda c, _: not c.state_valid, _A.FADE, "the vehicle does not trust its own position"),
    Row(_F.DISARMED, _W.PILOT, "not armed", lambda c, _: not c.armed, _A.FADE, "the vehicle is not armed"),
    Row(_F.LANDED, _W.PILOT, "not in the air", lambda c, _: not c.in_air, _A.FADE,
        "the vehicle is on the ground; take off first"),
    Row(_F.OVERSPEED, _W.PILOT, "faster than 1.5 times the limit and 1 m/s",
        lambda c, _: _too_fast(c.speed, c.speed_limit) or _too_fast(c.climb, c.climb_limit), _A.FADE,
        "the vehicle flies at {c.fastest:.1f} m/s, far over its limit"),
    Row(_F.MODE_TAKEN, _W.PILOT, "engaged, and the mode is not Offboard",
        lambda c, _: c.phase is Phase.ENGAGED and c.mode is not FlightMode.OFFBOARD, _A.FADE,
        "the vehicle went to {c.mode.name} by itself or by another"),
    Row(_F.MODE_MEANWHILE, _W.PILOT, "engaging, and the mode becomes neither Offboard nor Hold",
        lambda c, _: c.phase is not Phase.DISENGAGED and c.mode is not c.engaged_in and c.mode not in _WAITING,
        _A.FADE, "the vehicle went to {c.mode.name} meanwhile"),
    Row(_F.STREAM_STOPPED, _W.PILOT, "the link has streamed and streams no more",
        lambda c, _: c.streamed and c.streaming not in STREAMING, _A.FADE, "the link stopped passing setpoints"),
    Row(_F.UNCONFIRMED, _W.PILOT, "Offboard not confirmed within 3 s",
        lambda c, _: c.phase is Phase.ENGAGING and c.waited > ENGAGE_TIMEOUT_S, _A.FADE,
        f"the vehicle did not confirm Offboard within {ENGAGE_TIMEOUT_S:.0f} s"),
    Row(_F.UNSAFE, _W.PILOT, "a parameter in the table below forbids it", lambda c, _: bool(c.unsafe), _A.REFUSE,
        "{c.unsafe}", _WARNING),
    Row(_F.STREAM_ENDING, _W.PILOT, "the link has not ended the last stream", lambda c, _: c.streaming in STREAMING,
        _A.REFUSE, "the link is still ending the last stream of setpoints; engage again", _WARNING),
    Row(_F.NOT_CENTRED, _W.PILOT, "further than 15 % of its range from the centre", lambda c, _: not c.centred,
        _A.REFUSE, "the handle is not in its centre; bring it there and engage again", _WARNING),
    Row(_F.STATE_LATE, _W.PILOT, "position older than `force_stale_s` (0.1 s)",
        lambda c, s: late(c.state_age, s), _A.EASE, "The link is late: the force fades.", _INFO),
    Row(_F.FENCE, _W.PILOT, "the way leads over fence, floor or ceiling",
        lambda c, _: c.guarded_by in {"fence", "floor", "ceiling"}, _A.BOUND,
        "The guard acts: {c.guarded_by}.", _INFO),
    Row(_F.OBSTACLE, _W.PILOT, "the way leads into an obstacle, known or seen", lambda c, _: bool(c.guarded_by),
        _A.BOUND, "The guard acts: {c.guarded_by}.", _INFO),
    Row(_F.PILOT_SILENT, _W.LINK, "setpoint older than `setpoint_stale_s` (0.15 s)",
        lambda c, s: not c.setpoint_age <= s.setpoint_stale_s, _A.HOLD,
        "pilot silent for {c.setpoint_age:.2f} s; the vehicle holds"),
    Row(_F.STREAM_TAKEN, _W.LINK, "flying, and a heartbeat tells another mode than Offboard",
        lambda c, _: c.streaming is Stream.FLYING and c.mode is not FlightMode.OFFBOARD, _A.GIVE_WAY,
        "the vehicle went to {c.mode.name} by itself or by another; not fought"),
    Row(_F.LINK_SILENT, _W.LINK, "no frame for `link_warning_s` (0.5 s)",
        lambda c, s: c.silence > s.link_warning_s, _A.TELL, "The vehicle is silent for {c.silence:.1f} s."),
    Row(_F.PILOT_DEAD, _W.SUPERVISOR, "its process has ended", lambda c, _: "pilot" in c.ended, _A.RELEASE,
        "no force, and the vehicle is told to hold"),
    Row(_F.LINK_DEAD, _W.SUPERVISOR, "its process has ended", lambda c, _: "link" in c.ended, _A.RELEASE,
        "nothing reaches the vehicle; its own failsafe holds it"),
    Row(_F.RECORDER_DEAD, _W.SUPERVISOR, "its process has ended", lambda c, _: "recorder" in c.ended, _A.RELEASE,
        "this flight is no longer recorded"),
    Row(_F.SIM_DEAD, _W.SUPERVISOR, "its process has ended", lambda c, _: "sim" in c.ended, _A.RELEASE,
        "the simulated vehicle has gone"),
    Row(_F.PROCESS_DEAD, _W.SUPERVISOR, "its process has ended", lambda c, _: bool(c.ended), _A.RELEASE,
        "a part of this program is missing"),
    Row(_F.PROCESS_STALLED, _W.SUPERVISOR, "no heartbeat of a process for 1 s", lambda c, _: bool(c.stalled), _A.TELL,
        "does not answer"),
    Row(_F.SCREEN_DEAD, _W.ALL, "the process that started it is gone", lambda c, _: "screen" in c.ended, _A.END,
        "The screen has gone: the vehicle is told to hold, this process ends."),
    Row(_F.DISK_FULL, _W.RECORDER, "the recording cannot be written", lambda c, _: not c.written, _A.TELL,
        "This flight is no longer recorded"),
    Row(_F.DISK_LOW, _W.RECORDER, "less than `recording.warn_gb` (1 GB) left",
        lambda c, _: c.disk_gb < c.disk_least_gb, _A.TELL,
        "{c.disk_gb:.1f} GB left; make room after this flight", _WARNING),
    Row(_F.LINK_LOST, _W.SCREEN, "no frame for 2 s, or no heartbeat for 3 s",
        lambda c, _: not c.connected or not c.silence < LINK_LOST_S, _A.TELL,
        "Link lost: the vehicle has been silent for {c.silence:.1f} s."),
    Row(_F.BATTERY_EMPTY, _W.SCREEN, "15 % or less left", lambda c, _: c.battery <= BATTERY_EMPTY, _A.TELL,
        "Battery at {c.percent:.0f} %: land now."),
    Row(_F.BATTERY_LOW, _W.SCREEN, "30 % or less left", lambda c, _: c.battery <= BATTERY_LOW, _A.TELL,
        "Battery at {c.percent:.0f} %: land.", _WARNING),
    Row(_F.SERVO_OVERRUN, _W.SCREEN, "late by 5 ticks or more at the 99th percentile",
        lambda c, _: c.late >= OVERRUN_TICKS, _A.TELL,
        "The servo is late by {c.late:.0f} ticks (p99): the force is rough.", _WARNING),
)  # fmt: skip

BY_FAULT = {row.fault: row for row in TABLE}


def rows(who: Who, *actions: Action) -> tuple[Row, ...]:
    """Return the rows of one who acts, with these actions, or with any."""
    return tuple(row for row in TABLE if row.who is who and (not actions or row.action in actions))


def first(among: tuple[Row, ...], c: Conditions, safety: Safety) -> Row | None:
    """Return the first of some rows whose condition holds."""
    return next((row for row in among if row.holds(c, safety)), None)


def table() -> str:
    """Return the table in Markdown, as `docs/operating.md` shows it."""
    return "\n".join(_lines())


def _lines() -> Iterator[str]:
    yield "| fault | seen by | condition | action | words |"
    yield "|---|---|---|---|---|"
    for row in TABLE:
        words = re.sub(r"\{[^}]*\}", "…", row.words)
        yield f"| {row.fault} | {row.who} | {row.when} | {row.action} | {words} |"
