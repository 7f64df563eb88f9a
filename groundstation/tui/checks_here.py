"""The station's side of the checks before a flight: the hand, the servo, the mission, the recording."""

from __future__ import annotations

import math
import os
import shutil
from pathlib import Path

from groundstation.messages import Severity
from groundstation.tui import judge
from groundstation.tui.buttons import held
from groundstation.tui.check import Check
from groundstation.tui.frame import REPORT_STALE_S, Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import quantity, span_of_time

_GB = 1e9
# A recording and its MAVLink log grow by this while they are written, GB a minute; see docs/logs.md.
_GB_A_MINUTE = 0.020
# With less than one battery's flight left it is not begun; with less than an evening's it is told, min.
_LEAST_MINUTES, _FEW_MINUTES = 15.0, 60.0
_OK, _CAUTION, _DANGER = Severity.INFO, Severity.WARNING, Severity.ALARM


def device(frame: Frame) -> Check:
    """Return how the haptic device is."""
    device = frame.snapshot.device
    if device is None or frame.age(device) > REPORT_STALE_S:
        return Check("haptic device", _DANGER, "no word from the pilot process", "wait, or see the log (F12)")
    name = words(device.name)
    if frame.seeking:
        return Check("haptic device", _DANGER, "not found yet", "wait, or plug it in and switch it on")
    if not device.present:
        return Check("haptic device", _DANGER, f"{name} is not there", "plug it in and switch it on")
    if not device.homed:
        return Check("haptic device", _DANGER, f"{name} is not homed", "move the handle through its range")
    return Check("haptic device", _OK, f"{name}, up to {quantity(device.force_limit, 'N', 1)}")


def handle(frame: Frame) -> Check:
    """Return how the handle is: heard, and where engaging is possible."""
    handle = frame.snapshot.handle
    age = frame.now - handle.device_t if handle is not None and handle.present else math.inf
    if not age <= frame.run.settings.safety.handle_stale_s:
        state = f"last heard {span_of_time(age)} ago" if math.isfinite(age) else "not heard"
        return Check("handle", _DANGER, state, "see that the device is connected")
    enable = frame.run.settings.buttons.enable
    if enable >= 0 and enable not in held(handle):
        return Check(
            "handle", _CAUTION, "enable control not held", f"hold button {enable} to engage and to fly"
        )
    pilot = frame.pilot
    if pilot is not None and not pilot.centred:
        return Check("handle", _CAUTION, "heard, not centred", "bring it to its centre to engage")
    return Check("handle", _OK, "heard, centred")


def servo(frame: Frame) -> Check:
    """Return how well the servo keeps its time."""
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


def mission(frame: Frame) -> Check:
    """Return what is to be flown."""
    mission = frame.run.mission
    if mission is None:
        return Check("mission", _OK, "none: free flight")
    return Check("mission", _OK, f"{mission.name}: {mission.title}")


def recording(frame: Frame) -> Check:
    """Return where the recording goes, and how long the disk lasts."""
    state, folder = frame.states.get("recorder"), Path(frame.run.log).parent
    if state in ("ended", "silent"):
        return Check("recording", _DANGER, "the recorder does not run", "quit and start again")
    if state == "starting":
        return Check("recording", _CAUTION, "starting", "wait")
    if not os.access(folder, os.W_OK):
        return Check("recording", _DANGER, f"{folder} cannot be written", "start with another --logs")
    free = shutil.disk_usage(folder).free / _GB
    minutes = free / _GB_A_MINUTE
    lasts = f"{quantity(free, 'GB', 1)} free: {_lasting(minutes)} of flight"
    if minutes < _LEAST_MINUTES:
        return Check("recording", _DANGER, lasts, "make room on the disk")
    if minutes < _FEW_MINUTES or free < frame.run.settings.recording.warn_gb:
        return Check("recording", _CAUTION, lasts, "make room on the disk")
    return Check("recording", _OK, f"to {folder}, {lasts}")


def _lasting(minutes: float) -> str:
    return f"{minutes:.0f} min" if minutes < 120.0 else f"{minutes / 60.0:.0f} h"
