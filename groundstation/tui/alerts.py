"""What is wrong now, in sentences, and else what to do next."""

from __future__ import annotations

import math
from collections.abc import Iterator

from groundstation.messages import MappingMode, Phase, Severity
from groundstation.training.director import Stage
from groundstation.tui import judge
from groundstation.tui.acts import armed, in_air
from groundstation.tui.alarms import Alert
from groundstation.tui.frame import REPORT_STALE_S, STATUS_STALE_S, Frame
from groundstation.tui.notes import from_event, words
from groundstation.tui.rows import quantity, span_of_time

_RECENT_S = 5.0
_CONSEQUENCES = {
    "pilot": "no force, and the vehicle is told to hold",
    "link": "nothing reaches the vehicle; its own failsafe holds it",
    "sim": "the simulated vehicle has gone",
    "recorder": "this flight is no longer recorded",
}
# What the guard keeps away from beside obstacles.
_BOUNDS = {
    "floor": "the ground",
    "ceiling": "the ceiling",
    "fence": "the fence",
    "sensor": "what its sensors see",
}


def alerts(frame: Frame) -> Iterator[Alert]:
    """Yield all that is wrong, what explains the rest first; at the end what keeps the hand from being followed."""
    yield from _processes(frame)
    yield from _link(frame)
    yield from _state(frame)
    yield from _device(frame)
    yield from _said(frame)
    if hampered := _hampered(frame):
        yield Alert(Severity.INFO, "hampered", hampered)


def _processes(frame: Frame) -> Iterator[Alert]:
    for role, consequence in _CONSEQUENCES.items():
        state = frame.states.get(role)
        if state == "ended":
            yield Alert(Severity.ALARM, role, f"{role} has ended: {consequence}.")
        elif state == "silent":
            yield Alert(Severity.ALARM, role, f"{role} does not answer: {consequence}.")


def _link(frame: Frame) -> Iterator[Alert]:
    status = frame.snapshot.status
    if status is None or not status.heard_t:
        return
    age = judge.link_age(status, frame.now)
    severity = judge.link(status, frame.now, frame.run.settings.safety.link_warning_s)
    if severity is Severity.ALARM:
        yield Alert(
            severity, "link silent", f"Link lost: the vehicle has been silent for {span_of_time(age)}."
        )
    elif severity is Severity.WARNING:
        yield Alert(severity, "link silent", f"The vehicle has been silent for {span_of_time(age)}.")
    elif frame.age(status) > STATUS_STALE_S:
        age_words = span_of_time(frame.age(status))
        yield Alert(Severity.WARNING, "link report", f"No word from the link process for {age_words}.")
    if judge.battery(status.battery) is not Severity.INFO:
        charge = quantity(100 * status.battery, "%", 0)
        yield Alert(judge.battery(status.battery), "battery", f"Battery at {charge}: land.")


def _state(frame: Frame) -> Iterator[Alert]:
    vehicle = frame.snapshot.vehicle
    if vehicle is None or not in_air(frame.snapshot):
        return
    if frame.age(vehicle) > frame.run.settings.safety.state_stale_s:
        old = span_of_time(frame.age(vehicle))
        yield Alert(Severity.ALARM, "position", f"Position is {old} old: do not trust map or force.")
    elif not vehicle.valid:
        yield Alert(Severity.ALARM, "position", "The vehicle's position is not valid.")


def _device(frame: Frame) -> Iterator[Alert]:
    device = frame.snapshot.device
    if device is None:
        return
    if frame.age(device) > REPORT_STALE_S:
        silent = span_of_time(frame.age(device))
        yield Alert(Severity.WARNING, "device", f"No word from the haptic device for {silent}.")
    elif not device.present:
        text = "The haptic device is gone: plug it in again; the hand is uncoupled."
        yield Alert(Severity.ALARM, "device", text)
    elif not device.homed:
        text = "The haptic device is not homed: move the handle through its whole range."
        yield Alert(Severity.WARNING, "device", text)


def _said(frame: Frame) -> Iterator[Alert]:
    recent = [from_event(event) for event in frame.snapshot.events[-8:]]
    for note in reversed([*recent, *frame.notes]):
        if note.severity is not Severity.INFO and frame.now - note.t < _RECENT_S:
            yield Alert(note.severity, note.text, note.text)


def next_step(frame: Frame) -> str:
    """Say what the operator can do next."""
    snapshot = frame.snapshot
    status, pilot = snapshot.status, frame.pilot
    if status is None or not status.connected:
        return f"Waiting for the vehicle at {frame.run.url} …"
    if not armed(snapshot):
        return "Ready on the ground. A arms."
    if not in_air(snapshot):
        return "Armed on the ground. T takes off."
    if pilot is None:
        return "In the air. Waiting for the pilot process …"
    if pilot.phase == Phase.ENGAGED:
        return _engaged_hint(frame)
    if pilot.phase == Phase.ENGAGING:
        return "Engaging: the vehicle is asked to follow …"
    reason = words(pilot.reason)
    uncoupled = f"Hand uncoupled ({reason})." if reason else "In the air, hand uncoupled."
    return f"{uncoupled} {'E engages.' if pilot.centred else 'Centre the handle, then E engages.'}"


def _engaged_hint(frame: Frame) -> str:
    mission, still = frame.run.mission, _standstill(frame)
    progress, target = frame.snapshot.progress, distance_to_target(frame)
    if progress is not None and words(progress.stage) == Stage.RETURNING.value and math.isfinite(target):
        return f"Engaged. The target is held: mission flown. {still}, L lands."
    if mission is not None and mission.target is not None and math.isfinite(target):
        return f"Engaged. Target {quantity(target, 'm', 1)} away. {still}, X releases."
    return f"Engaged. {still}, X releases, H holds."


def _hampered(frame: Frame) -> str:
    """Say why the vehicle does not do what the hand does, or ""."""
    pilot = frame.pilot
    if pilot is None:
        return ""
    if pilot.clutched:
        return "Clutch: the handle moves nothing. C takes hold again."
    if pilot.waiting:
        return "Centre the handle to take hold."
    if frame.guarded_by:
        return f"Guard: it keeps the vehicle away from {_BOUNDS.get(frame.guarded_by, frame.guarded_by)}."
    return (
        "On the leash: the vehicle does not keep up, the force shows where it is." if pilot.on_leash else ""
    )


def _standstill(frame: Frame) -> str:
    """Say how the hand gets the vehicle to stand, or itself some way to go."""
    pilot = frame.pilot
    if pilot is not None and pilot.mapping == MappingMode.POSITION:
        return "C clutches to reach on"
    return "Space lets go of the stick" if frame.stick is not None else "The handle's centre is standstill"


def distance_to_target(frame: Frame) -> float:
    """Return the way to the mission's target, m; NaN where there is none."""
    mission, vehicle = frame.run.mission, frame.snapshot.vehicle
    if mission is None or mission.target is None or vehicle is None:
        return math.nan
    return math.dist(mission.target.position, tuple(vehicle.position)[:3])
