"""The top of the screen: what flies, who steers it, and whether link, servo and battery are well."""

from __future__ import annotations

import math

from groundstation.messages import FlightMode, Phase, Severity, VehicleStatus
from groundstation.tui import judge
from groundstation.tui.acts import armed, in_air
from groundstation.tui.frame import REPORT_STALE_S, STATUS_STALE_S, Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import Row, Span, clock, quantity, span_of_time, spread, width_of
from groundstation.tui.theme import MARKS, TONES, Tone
from groundstation.tui.widgets.instrument import Instrument

_WIDE = 100
# Letters of a name on a narrow screen.
_BRIEF = 9
_NO_PILOT = (" ■ NO PILOT ", Tone.CHIP_FAULT)
_PHASES: dict[int, Span] = {
    Phase.DISENGAGED: (" RELEASED ", Tone.CHIP),
    Phase.ENGAGING: (" ENGAGING… ", Tone.CAUTION),
    Phase.ENGAGED: (" ENGAGED ", Tone.CHIP_HAND),
}


class StatusBar(Instrument):
    """Two lines that are always there."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw chips above, figures below."""
        del height
        chips = [_kind(frame, width), *_chips(frame, width)]
        link = _link(frame)
        return [
            spread(chips, _right(frame, width, width - width_of(chips)), width),
            spread(link, _servo(frame, width - width_of(link)), width),
        ]


def _kind(frame: Frame, width: int) -> Span:
    if frame.run.simulated:
        return " ○ SIM ", Tone.SIMULATED
    return " ■ REAL VEHICLE " if width >= _WIDE else " ■ REAL ", Tone.REAL


def _chips(frame: Frame, width: int) -> Row:
    snapshot = frame.snapshot
    status = snapshot.status
    if status is None:
        return [(" NO VEHICLE ", Tone.CHIP)]
    chips = [(f" {judge.mode_word(status.mode)} ", _mode_tone(status))]
    chips.append((" ARMED ", Tone.CHIP_OK) if armed(snapshot) else (" DISARMED ", Tone.CHIP))
    if in_air(snapshot):
        chips.append((" AIR ", Tone.CHIP_OK))
    elif armed(snapshot):
        chips.append((" GROUND ", Tone.CHIP))
    old = frame.age(status) > STATUS_STALE_S
    if old:
        chips = [(text, Tone.STALE) for text, _ in chips]
    if snapshot.pilot is not None:
        chips.append(_PHASES.get(frame.pilot.phase, _NO_PILOT) if frame.pilot else _NO_PILOT)
    chips += _signs(frame, width)
    row: Row = []
    for chip in chips:
        row += [(" ", Tone.TEXT), chip]
    if old:
        row.append((f" ▲ {span_of_time(frame.age(status))} old", Tone.WARN))
    return row


def _signs(frame: Frame, width: int) -> list[Span]:
    """Return what keeps the vehicle from doing what the hand does: the guard, the clutch, a handle off its centre."""
    pilot = frame.pilot
    if pilot is None or pilot.phase != Phase.ENGAGED:
        return []
    signs: list[Span] = []
    if frame.guarded_by:
        name = frame.guarded_by if width >= _WIDE else frame.guarded_by[:_BRIEF]
        signs.append((f" ▲ GUARD {name} ", Tone.CAUTION))
    if pilot.clutched:
        signs.append((" CLUTCH ", Tone.CAUTION))
    elif pilot.waiting:
        signs.append((" CENTRE HANDLE ", Tone.CAUTION))
    return signs if width >= _WIDE else signs[:1]


def _mode_tone(status: VehicleStatus) -> Tone:
    return Tone.CHIP_HAND if status.mode == FlightMode.OFFBOARD else Tone.CHIP


def _right(frame: Frame, width: int, room: int) -> Row:
    """Return mission, device, battery and clock; mission and device only where there is room."""
    row = [*_battery(frame, width), (f"  {clock(frame.now - frame.started)} ", Tone.MUTED)]
    for part in (_device(frame), [(f"{_mission(frame)}   ", Tone.MUTED)] if width >= _WIDE else []):
        if width_of(part) + width_of(row) < room:
            row = [*part, *row]
    return row


def _device(frame: Frame) -> Row:
    device = frame.snapshot.device
    if device is None:
        return []
    if frame.seeking:
        return [("no device yet", Tone.WARN), ("  ", Tone.TEXT)]
    old = frame.age(device) > REPORT_STALE_S
    tone = Tone.STALE if old else Tone.TEXT if device.present else Tone.FAULT
    return [(words(device.name)[:24], tone), ("  ", Tone.TEXT)]


def _battery(frame: Frame, width: int) -> Row:
    status = frame.snapshot.status
    if status is None:
        return []
    severity = judge.battery(status.battery)
    charge = quantity(100 * status.battery, "%", 0)
    known = width >= _WIDE and math.isfinite(status.voltage)
    volts = f" {quantity(status.voltage, 'V', 1)}" if known else ""
    tone = Tone.STALE if frame.age(status) > STATUS_STALE_S else TONES[severity]
    return [(f"{MARKS[severity]}BAT {charge}{volts}", tone)]


def _mission(frame: Frame) -> str:
    """Return the mission's name and how far it is."""
    mission, progress = frame.run.mission, frame.snapshot.progress
    if mission is None:
        return "free flight"
    if progress is None or not progress.legs:
        return mission.name
    point = min(progress.leg + 1, progress.legs)
    touched = f", {progress.collisions} collisions" if progress.collisions else ""
    return f"{mission.name}: {words(progress.stage)}, point {point}/{progress.legs}{touched}"


def _figure(label: str, value: str, severity: Severity) -> Row:
    mark = MARKS[severity]
    if severity is Severity.ALARM:
        return [(f"{mark}{label} {value}", TONES[severity]), (" ", Tone.TEXT)]
    tone = Tone.STRONG if severity is Severity.INFO else TONES[severity]
    return [(mark, tone), (f"{label} ", Tone.MUTED), (value, tone), (" ", Tone.TEXT)]


def _link(frame: Frame) -> Row:
    status = frame.snapshot.status
    if status is None:
        return _figure("LINK", "no word from the link process", Severity.WARNING)
    severity = judge.link(status, frame.now, frame.run.settings.safety.link_warning_s)
    age = judge.link_age(status, frame.now)
    heard = span_of_time(age) if math.isfinite(age) else "never heard"
    loss = judge.above(status.loss, judge.LOSS_WARNING, judge.LOSS_ALARM)
    trip = judge.above(status.rtt, judge.RTT_WARNING_S, judge.RTT_ALARM_S)
    figures = [
        *_figure("loss", quantity(100 * status.loss, "%", 1), loss),
        *_figure("RTT", quantity(1000 * status.rtt, "ms", 0), trip),
    ]
    if frame.age(status) > STATUS_STALE_S:
        figures = [(text, Tone.STALE) for text, _ in figures]
    return [*_figure("LINK", heard, severity), *figures, *_left_by_link(frame)]


def _left_by_link(frame: Frame) -> Row:
    """Return what the link leaves of gains and speed, where that is not all."""
    pilot = frame.pilot
    if pilot is None or not min(pilot.gain_share, pilot.speed_share) < 1.0:
        return []
    return [
        *_figure("gains", quantity(100 * pilot.gain_share, "%", 0), Severity.WARNING),
        *_figure("speed", quantity(100 * pilot.speed_share, "%", 0), Severity.WARNING),
    ]


def _servo(frame: Frame, room: int) -> Row:
    servo = frame.snapshot.servo
    if servo is None:
        return _figure("SERVO", "no word from the pilot process", Severity.WARNING)
    old = frame.age(servo) > REPORT_STALE_S
    late, missed = judge.lateness(servo), judge.missed(servo)
    row: Row = []
    for figure in (
        _figure("SERVO", quantity(servo.rate, "Hz", 0), Severity.WARNING if old else Severity.INFO),
        _figure("p99", quantity(1000 * servo.late_p99, "ms"), late),
        _figure("lost", f"{servo.missed} ticks", missed),
    ):
        if width_of(row) + width_of(figure) < room:
            row += figure
    return [(text, Tone.STALE) for text, _ in row] if old else row
