"""What is wrong now, as conditions with a priority: from the records, the processes, and what was said."""

from __future__ import annotations

import re
from collections.abc import Iterator

from groundstation.conditions import Conditions
from groundstation.failsafe import BY_FAULT, Action, Fault, Who, first, rows
from groundstation.messages import Phase, Preset, Severity
from groundstation.pilot.presets import PRESETS
from groundstation.tui import judge
from groundstation.tui.acts import in_air
from groundstation.tui.alarms import Condition
from groundstation.tui.frame import REPORT_STALE_S, STATUS_STALE_S, Frame
from groundstation.tui.hints import as_told
from groundstation.tui.notes import from_event
from groundstation.tui.rows import quantity, span_of_time
from groundstation.vehicle.profiles import profile_of

# What was said counts as being so for this long, s, and no more of it is looked through.
_RECENT_S, _RECENT = 5.0, 12
_DEATHS, _GUARD = rows(Who.SUPERVISOR, Action.RELEASE), rows(Who.PILOT, Action.BOUND)
_LOST, _STALLED = BY_FAULT[Fault.LINK_LOST], BY_FAULT[Fault.PROCESS_STALLED]
_BATTERY = (BY_FAULT[Fault.BATTERY_EMPTY], BY_FAULT[Fault.BATTERY_LOW])
_OVERRUN = BY_FAULT[Fault.SERVO_OVERRUN]
# A device that is there has been found and opened after so long, also on a busy machine, s.
_FOUND_S = 10.0
_FIGURES = re.compile(r"[\d.]+")


def conditions(frame: Frame) -> list[Condition]:
    """Return all that is wrong, and what is worth knowing, of a frame."""
    found = (_processes, _link, _state, _device, _servo, _advice, _said)
    return [condition for look in found for condition in look(frame)]


def _processes(frame: Frame) -> Iterator[Condition]:
    gone = {role for role, state in frame.states.items() if state in {"ended", "silent"}}
    safety = frame.run.settings.safety
    # The worst first, as the table has them.
    while row := first(_DEATHS, Conditions(ended=frozenset(gone)), safety):
        for role in sorted(gone):
            if row.holds(Conditions(ended=frozenset({role})), safety):
                gone.remove(role)
                how = "has ended" if frame.states[role] == "ended" else _STALLED.words
                yield Condition(f"process {role}", row.severity, f"{role} {how}: {row.words}.")


def _link(frame: Frame) -> Iterator[Condition]:
    status, safety = frame.snapshot.status, frame.run.settings.safety
    if status is None or not status.heard_t:
        return
    age = judge.link_age(status, frame.now)
    c = Conditions(connected=bool(status.connected), silence=age, battery=status.battery)
    if _LOST.holds(c, safety):
        yield Condition("link", _LOST.severity, _LOST.say(c))
    elif judge.link(status, frame.now, safety.link_warning_s) is not Severity.INFO:
        yield Condition("link", Severity.WARNING, f"The vehicle has been silent for {span_of_time(age)}.")
    elif frame.age(status) > STATUS_STALE_S:
        text = f"No word from the link process for {span_of_time(frame.age(status))}."
        yield Condition("link process", Severity.WARNING, text)
    if row := first(_BATTERY, c, safety):
        yield Condition("battery", row.severity, row.say(c))
    if (profile := profile_of(status.autopilot)) and not profile.tested:
        text = f"{profile.name} has never been flown with this program: untested."
        yield Condition("untested", Severity.INFO, text)


def _state(frame: Frame) -> Iterator[Condition]:
    vehicle = frame.snapshot.vehicle
    if vehicle is None or not in_air(frame.snapshot):
        return
    age = frame.age(vehicle)
    if age > frame.run.settings.safety.state_stale_s:
        text = f"Position is {span_of_time(age)} old: do not trust map or force."
        yield Condition("position", Severity.ALARM, text)
    elif not vehicle.valid:
        yield Condition("position", Severity.ALARM, "The vehicle's position is not valid.")


def _device(frame: Frame) -> Iterator[Condition]:
    device = frame.snapshot.device
    if device is None:
        return
    if frame.age(device) > REPORT_STALE_S:
        text = f"No word from the haptic device for {span_of_time(frame.age(device))}."
        yield Condition("device", Severity.WARNING, text)
    elif frame.seeking:
        if frame.now - frame.started > _FOUND_S:
            text = "No haptic device has been found: plug it in and switch it on."
            yield Condition("device", Severity.ALARM, text)
    elif not device.present:
        text = "The haptic device is gone: plug it in again; the hand is uncoupled."
        yield Condition("device", Severity.ALARM, text)
    elif not device.homed:
        text = "The haptic device is not homed: move the handle through its whole range."
        yield Condition("device", Severity.WARNING, text)


def _servo(frame: Frame) -> Iterator[Condition]:
    servo = frame.snapshot.servo
    if servo is None or frame.age(servo) > REPORT_STALE_S:
        return
    c = Conditions(late=servo.late_p99 * servo.rate)
    if _OVERRUN.holds(c, frame.run.settings.safety):
        yield Condition("servo", _OVERRUN.severity, _OVERRUN.say(c))
    if not servo.realtime:
        text = "The servo has no real-time priority: a busy machine makes it late."
        yield Condition("priority", Severity.INFO, text)


def _advice(frame: Frame) -> Iterator[Condition]:
    """What is not wrong, but is to be known."""
    pilot = frame.pilot
    if pilot is None or pilot.phase != Phase.ENGAGED:
        return
    if pilot.on_leash:
        yield Condition("leash", Severity.INFO, "On the leash: the vehicle does not keep up with the hand.")
    c = Conditions(guarded_by=frame.guarded_by)
    if row := first(_GUARD, c, frame.run.settings.safety):
        yield Condition("guard", row.severity, row.say(c))
    if not PRESETS[Preset(pilot.preset)].guard:
        yield Condition("no guard", Severity.INFO, "No guard: nothing keeps the vehicle from obstacles.")
    if min(pilot.gain_share, pilot.speed_share) < 1.0:
        gains, speed = (quantity(100 * share, "%", 0) for share in (pilot.gain_share, pilot.speed_share))
        yield Condition("poor link", Severity.INFO, f"The link leaves {gains} of gains, {speed} of speed.")


def _said(frame: Frame) -> Iterator[Condition]:
    """What was told as a warning or an alarm a moment ago; the same with other figures is the same."""
    recent = [from_event(event) for event in frame.snapshot.events[-_RECENT:]]
    for note in [*recent, *frame.notes]:
        if note.severity is not Severity.INFO and frame.now - note.t < _RECENT_S:
            text = as_told(note.text, frame)
            yield Condition(f"said {_FIGURES.sub('#', text)}", note.severity, text, note.t)
