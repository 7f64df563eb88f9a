"""The line of words: the most pressing that is wrong, or what to do next."""

from __future__ import annotations

from dataclasses import replace

from groundstation.messages import Severity
from groundstation.tui.alarms import Alarm, Alarms
from groundstation.tui.frame import Frame
from groundstation.tui.hints import next_step
from groundstation.tui.rows import Row, fit, span_of_time
from groundstation.tui.theme import PRIORITIES, Tone
from groundstation.tui.widgets.instrument import Instrument

_TONES = {Severity.INFO: Tone.NOTE, Severity.WARNING: Tone.CAUTION, Severity.ALARM: Tone.ALARM}


class Banner(Instrument):
    """One line over the whole width."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the most pressing alarm and how many more there are, or the next step."""
        del height
        alarm = frame.alarms.first()
        if alarm is None:
            tone, left = Tone.NOTE, f" › {next_step(frame)}"
        else:
            tone = Tone.WARN if alarm.seen else _TONES[alarm.severity]
            left = f" {headline(alarm, frame.now)}"
        right = _right(frame.alarms, alarm)
        if alarm is not None and len(left) + len(right) > width:
            left = f" {headline(replace(alarm, text=_shorter(alarm.text)), frame.now)}"
        room = max(width - len(right), 0)
        return [[*fit([(left, tone), (" " * room, tone)], room), (right, tone)]]


def headline(alarm: Alarm, now: float) -> str:
    """Return an alarm in a line: priority, how often, whether it is over or seen, and what it is."""
    times = f" ×{alarm.count}" if alarm.count > 1 else ""
    seen = " seen" if alarm.seen else ""
    over = "" if alarm.active else f" {span_of_time(now - alarm.ended)} ago"
    return f"{PRIORITIES[alarm.severity]}{times}{seen}{over}  {alarm.text}"


def _shorter(text: str) -> str:
    """Return a refusal's reason without what was refused: where there is little room that is what must fit."""
    said, _, reason = text.partition(" refused: ")
    return reason[:1].upper() + reason[1:] if reason else said


def _right(alarms: Alarms, shown: Alarm | None) -> str:
    """Return how many more there are, the key that acknowledges, and whether the bell is muted."""
    listed = alarms.listed()
    serious = sum(alarm is not shown and alarm.severity > Severity.INFO for alarm in listed)
    advice = sum(alarm is not shown and alarm.severity is Severity.INFO for alarm in listed)
    words = [f"▲ +{serious}"] if serious else []
    words += [f"◇ {advice}"] if advice else []
    words += ["b bell off"] if alarms.muted else []
    words += ["o seen"] if shown is not None and not shown.seen else []
    return f" {'  '.join(words)} " if words else ""
