"""What is looked at before a flight: each check's state in words and, where it is not well, what to do."""

from __future__ import annotations

import math
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from groundstation.messages import Health, Severity
from groundstation.tui import judge
from groundstation.tui.frame import REPORT_STALE_S, Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import quantity, span_of_time
from groundstation.vehicle.failsafes import FAILSAFES, verdict

_GB = 1e9
_OK, _CAUTION, _DANGER = Severity.INFO, Severity.WARNING, Severity.ALARM


class Check(NamedTuple):
    """One check.

    Attributes:
        name: Of what is looked at.
        severity: ALARM: not to be flown so.
        state: How it is.
        remedy: What to do, or "".
    """

    name: str
    severity: Severity
    state: str
    remedy: str = ""


def checks(frame: Frame) -> list[Check]:
    """Return all checks: what forbids to fly first, else the hand's, the vehicle's, its own failsafes."""
    found = [
        _device(frame),
        _handle(frame),
        _servo(frame),
        _link(frame),
        _position(frame),
        _home(frame),
        _battery(frame),
        _fence(frame),
        _mission(frame),
        _recording(frame),
        *_failsafes(frame),
    ]
    return sorted(found, key=lambda check: check.severity is not _DANGER)


def red(frame: Frame) -> int:
    """Return how many checks forbid to fly."""
    return sum(check.severity is _DANGER for check in checks(frame))


def _device(frame: Frame) -> Check:
    device = frame.snapshot.device
    if device is None or frame.age(device) > REPORT_STALE_S:
        return Check("haptic device", _DANGER, "no word from the pilot process", "wait, or see the log (F12)")
    name = words(device.name)
    if not device.present:
        return Check("haptic device", _DANGER, f"{name} is not there", "plug it in and switch it on")
    if not device.homed:
        return Check("haptic device", _DANGER, f"{name} is not homed", "move the handle through its range")
    return Check("haptic device", _OK, f"{name}, up to {quantity(device.force_limit, 'N', 1)}")


def _handle(frame: Frame) -> Check:
    handle = frame.snapshot.handle
    age = frame.now - handle.device_t if handle is not None and handle.present else math.inf
    if not age <= frame.run.settings.safety.handle_stale_s:
        state = f"last heard {span_of_time(age)} ago" if math.isfinite(age) else "not heard"
        return Check("handle", _DANGER, state, "see that the device is connected")
    pilot = frame.pilot
    if pilot is not None and not pilot.centred:
        return Check("handle", _CAUTION, "heard, not centred", "bring it to its centre to engage")
    return Check("handle", _OK, "heard, centred")


def _servo(frame: Frame) -> Check:
    servo = frame.snapshot.servo
    if servo is None or frame.age(servo) > REPORT_STALE_S:
        return Check("servo", _DANGER, "no word from the pilot process", "wait, or see the log (F12)")
    worst = max(judge.lateness(servo), judge.missed(servo))
    state = (
        f"{quantity(servo.rate, 'Hz', 0)}, late {quantity(1000 * servo.late_p99, 'ms')} p99, "
        f"{servo.missed} ticks lost"
    )
    if not servo.realtime:
        return Check("servo", max(worst, _CAUTION), state, "no real-time priority: see docs/operating.md")
    return Check("servo", worst, state, "end other programs" if worst else "")


def _link(frame: Frame) -> Check:
    status = frame.snapshot.status
    severity = judge.link(status, frame.now, frame.run.settings.safety.link_warning_s)
    if status is None or not status.connected:
        return Check("link", _DANGER, f"no vehicle at {frame.run.url}", "switch it on, check the address")
    state = (
        f"vehicle {status.system_id} heard {span_of_time(judge.link_age(status, frame.now))} ago, "
        f"loss {quantity(100 * status.loss, '%', 1)}, RTT {quantity(1000 * status.rtt, 'ms', 0)}"
    )
    return Check("link", severity, state, "check radio and antennas" if severity else "")


def _health(frame: Frame) -> Health:
    status = frame.snapshot.status
    return Health(status.health) if status is not None else Health(0)


def _position(frame: Frame) -> Check:
    vehicle = frame.snapshot.vehicle
    age = frame.age(vehicle)
    if vehicle is None or age > frame.run.settings.safety.state_stale_s:
        state = f"{span_of_time(age)} old" if math.isfinite(age) else "not told yet"
        return Check("position", _DANGER, state, "wait for the estimator, or check the link")
    if not vehicle.valid or Health.LOCAL_POSITION not in _health(frame):
        return Check("position", _DANGER, "the vehicle does not trust it", "wait for GPS or optical flow")
    return Check("position", _OK, f"trusted, {span_of_time(age)} old")


def _home(frame: Frame) -> Check:
    if Health.HOME in _health(frame):
        return Check("home", _OK, "set")
    return Check("home", _CAUTION, "not set: Return has nowhere to go", "wait for GPS, or arm to set it")


def _battery(frame: Frame) -> Check:
    status = frame.snapshot.status
    share = status.battery if status is not None else math.nan
    if not math.isfinite(share):
        return Check("battery", _CAUTION, "the vehicle does not say", "look at the battery yourself")
    severity = judge.battery(share)
    return Check(
        "battery", severity, quantity(100 * share, "%", 0), "charge or change it" if severity else ""
    )


def _fence(frame: Frame) -> Check:
    mission, shield = frame.run.mission, frame.run.settings.shield
    fence = mission.fence if mission is not None else None
    radius, ceiling = (fence.radius, fence.ceiling) if fence else (shield.fence, shield.ceiling)
    if shield.guard == "off":
        return Check("fence", _CAUTION, "the guard is off in the settings", "shield.guard in Settings (F10)")
    if not radius and not ceiling:
        severity = _OK if frame.run.simulated else _CAUTION
        return Check("fence", severity, "none set", "" if frame.run.simulated else "set shield.fence (F10)")
    bounds = [f"{quantity(radius, 'm', 0)} around"] if radius else []
    bounds += [f"up to {quantity(ceiling, 'm', 0)}"] if ceiling else []
    return Check("fence", _OK, ", ".join(bounds))


def _mission(frame: Frame) -> Check:
    mission = frame.run.mission
    if mission is None:
        return Check("mission", _OK, "none: free flight")
    return Check("mission", _OK, f"{mission.name}: {mission.title}")


def _recording(frame: Frame) -> Check:
    state, folder = frame.states.get("recorder"), Path(frame.run.log).parent
    if state in ("ended", "silent"):
        return Check("recording", _DANGER, "the recorder does not run", "quit and start again")
    if state == "starting":
        return Check("recording", _CAUTION, "starting", "wait")
    if not os.access(folder, os.W_OK):
        return Check("recording", _DANGER, f"{folder} cannot be written", "start with another --logs")
    free, least = shutil.disk_usage(folder).free / _GB, frame.run.settings.recording.warn_gb
    if free < least:
        return Check("recording", _CAUTION, f"{quantity(free, 'GB', 1)} free on the disk", "make room")
    return Check("recording", _OK, f"to {folder}, {quantity(free, 'GB', 0)} free")


def _failsafes(frame: Frame) -> Iterator[Check]:
    read = frame.snapshot.parameters
    values = {name: parameter.value for name, parameter in read.items()}
    for failsafe in FAILSAFES:
        judged = verdict(failsafe, values)
        known = f" = {values[failsafe.name]:g}" if failsafe.name in values else ""
        yield Check(f"{failsafe.name}{known}", judged.severity, judged.means, judged.remedy)
