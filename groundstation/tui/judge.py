"""How bad is it: figures of link, battery and servo judged as normal, warning or alarm."""

from __future__ import annotations

import math

from groundstation.failsafe import BATTERY_EMPTY, BATTERY_LOW, LINK_LOST_S, OVERRUN_TICKS
from groundstation.messages import FlightMode, ServoReport, Severity, VehicleStatus

LOSS_WARNING, LOSS_ALARM = 0.02, 0.10
# Time-domain passivity has been shown to 0.7 s of round trip; a quarter of a second is clearly seen.
RTT_WARNING_S, RTT_ALARM_S = 0.25, 0.70
MISSED_WARNING, MISSED_ALARM = 0.001, 0.01
# Ticks of lateness: one means that a whole tick was lost.
LATE_WARNING = 1.0
# A few missed while starting up are no share of anything yet.
_TICKS_TO_JUDGE = 10_000
_MODES = frozenset(FlightMode)


def above(value: float, warning: float, alarm: float) -> Severity:
    """Judge a figure that is bad when large; not knowing it is a warning."""
    if not math.isfinite(value):
        return Severity.WARNING
    return Severity.ALARM if value >= alarm else Severity.WARNING if value >= warning else Severity.INFO


def link_age(status: VehicleStatus | None, now: float) -> float:
    """Return how long the vehicle has been silent, s; infinite where it was never heard."""
    return now - status.heard_t if status is not None and status.heard_t > 0 else math.inf


def link(status: VehicleStatus | None, now: float, warning_s: float) -> Severity:
    """Judge the vehicle's silence."""
    if status is None or not status.connected:
        return Severity.ALARM
    age = link_age(status, now)
    return Severity.ALARM if not math.isfinite(age) else above(age, warning_s, LINK_LOST_S)


def battery(share: float) -> Severity:
    """Judge what is left, 0 to 1; a vehicle that does not say is no alarm."""
    if not math.isfinite(share):
        return Severity.INFO
    return above(-share, -BATTERY_LOW, -BATTERY_EMPTY)


def lateness(servo: ServoReport) -> Severity:
    """Judge the servo's lateness (99th percentile) against its tick."""
    return above(servo.late_p99 * servo.rate, LATE_WARNING, OVERRUN_TICKS)


def missed(servo: ServoReport) -> Severity:
    """Judge the share of ticks that did not run."""
    return above(servo.missed / max(servo.ticks, _TICKS_TO_JUDGE), MISSED_WARNING, MISSED_ALARM)


def mode_word(mode: int) -> str:
    """Write who steers the vehicle."""
    return FlightMode(mode).name if mode in _MODES else FlightMode.OTHER.name
