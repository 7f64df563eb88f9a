"""The machinery: processes, servo, link and device in figures."""

from __future__ import annotations

import math

from groundstation.messages import Severity, Stream
from groundstation.tui import judge
from groundstation.tui.frame import REPORT_STALE_S, STATUS_STALE_S, Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import UNKNOWN, Row, quantity
from groundstation.tui.theme import MARKS, TONES, Tone
from groundstation.tui.widgets.instrument import Instrument

_STREAMS = {stream.value: stream.name.lower() for stream in Stream}
_STATES = {"running": Severity.INFO, "starting": Severity.WARNING}


class System(Instrument):
    """Label and value a row."""

    BORDER_TITLE = "system"
    EVERY = 15

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw what is known."""
        snapshot = frame.snapshot
        rows = [*_processes(frame), *_ages(frame)]
        rows += _aged(_servo(frame), frame.age(snapshot.servo), REPORT_STALE_S)
        rows += _aged(_link(frame), frame.age(snapshot.status), STATUS_STALE_S)
        rows += _aged(_device(frame), frame.age(snapshot.device), REPORT_STALE_S)
        return [*rows, *_screen(frame), *_state_age(frame), *_files(frame, width)][:height]


def _aged(rows: list[Row], age: float, limit: float) -> list[Row]:
    """Return the rows, all in the stale tone where what they show is old."""
    return [[(text, Tone.STALE) for text, _ in row] for row in rows] if age > limit else rows


def _row(label: str, *parts: tuple[str, Tone]) -> Row:
    return [(f" {label:<10}", Tone.MUTED), *parts]


def _processes(frame: Frame) -> list[Row]:
    if not frame.states:
        return [_row("processes", ("not watched", Tone.MUTED))]
    rows: list[Row] = []
    for role, state in frame.states.items():
        severity = _STATES.get(state, Severity.ALARM)
        mark = "●" if severity is Severity.INFO else MARKS[severity]
        tone = Tone.OK if severity is Severity.INFO else TONES[severity]
        part = [(f" {role:<10}", Tone.MUTED), (f"{mark} {state:<12}", tone)]
        if rows and len(rows[-1]) == len(part):
            rows[-1].extend(part)
        else:
            rows.append(part)
    return rows


def _ages(frame: Frame) -> list[Row]:
    """Return how old each record is."""
    shown = frame.snapshot
    steering = (("handle", shown.handle), ("state", shown.vehicle), ("setpoint", shown.setpoint))
    others = (
        ("pilot", shown.pilot),
        ("link", shown.status),
        ("servo", shown.servo),
        ("device", shown.device),
    )
    return [
        _row(label, (" ".join(f"{name} {_seconds(frame.age(record))}" for name, record in part), Tone.TEXT))
        for label, part in (("ages, s", steering), ("", others))
    ]


def _seconds(age: float) -> str:
    """Write an age in four cells."""
    return f"{age:.2f}" if age < 10.0 else f"{age:4.0f}" if math.isfinite(age) else f"{UNKNOWN:>4}"


def _screen(frame: Frame) -> list[Row]:
    full = frame.run.settings.rates.screen
    if not math.isfinite(frame.paint_hz):
        return []
    slower = frame.paint_hz < 0.99 * full
    words = "▲ the terminal is slow" if slower else "as often as is asked for"
    return [
        _row(
            "painting", (f"{quantity(frame.paint_hz, 'Hz', 0)}, {words}", Tone.WARN if slower else Tone.TEXT)
        )
    ]


def _servo(frame: Frame) -> list[Row]:
    servo = frame.snapshot.servo
    if servo is None:
        return [_row("servo", ("no report yet", Tone.MUTED))]
    times = (("p50", servo.late_p50), ("p99", servo.late_p99), ("max", servo.late_max))
    late = "  ".join(f"{name} {quantity(1000 * value, 'ms')}" for name, value in times)
    work = (("read", servo.read), ("step", servo.step), ("write", servo.write))
    busy = "  ".join(f"{name} {quantity(1000 * value, 'ms')}" for name, value in work)
    priority = "real-time priority" if servo.realtime else "▲ no real-time priority"
    return [
        _row("late", (late, TONES[judge.lateness(servo)])),
        _row("work", (busy, Tone.TEXT)),
        _row("ticks", (f"{servo.ticks} run, {servo.missed} missed, {priority}", TONES[judge.missed(servo)])),
    ]


def _link(frame: Frame) -> list[Row]:
    status = frame.snapshot.status
    if status is None:
        return []
    stream = _STREAMS.get(status.streaming, "unknown")
    counts = f"{status.sent} sent, {status.dropped} kept back, stream {stream}"
    return [_row("setpoints", (counts, Tone.TEXT))]


def _state_age(frame: Frame) -> list[Row]:
    """Return how old the vehicle's state was when the pilot last used it."""
    pilot = frame.snapshot.pilot
    if pilot is None or not math.isfinite(pilot.state_age):
        return []
    return [_row("state", (f"{quantity(1000 * pilot.state_age, 'ms', 0)} old where it is used", Tone.TEXT))]


def _device(frame: Frame) -> list[Row]:
    device = frame.snapshot.device
    if device is None:
        return [_row("device", ("no report yet", Tone.MUTED))]
    if frame.seeking:
        return [_row("device", ("not found yet", Tone.WARN))]
    state = "ready" if device.present and device.homed else "not homed" if device.present else "gone"
    limits = f"  {quantity(1000 * device.workspace, 'mm', 0)}, {quantity(device.force_limit, 'N', 1)}"
    return [_row("device", (f"{words(device.name)}: {state}", Tone.TEXT), (limits, Tone.MUTED))]


def _files(frame: Frame, width: int) -> list[Row]:
    room = max(width - 12, 8)
    return [
        _row("vehicle", (frame.run.url[-room:], Tone.TEXT)),
        _row("recording", (str(frame.run.recording)[-room:], Tone.TEXT)),
    ]
