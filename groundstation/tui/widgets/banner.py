"""The line of words: the most pressing that is wrong, or what to do next."""

from __future__ import annotations

from groundstation.messages import Severity
from groundstation.tui.alarms import Alarm
from groundstation.tui.frame import Frame
from groundstation.tui.hints import next_step
from groundstation.tui.rows import Row, Span, fit, span_of_time, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

WORDS = {Severity.INFO: "◇ ADVICE", Severity.WARNING: "▲ CAUTION", Severity.ALARM: "■ ALARM"}
_TONES = {Severity.WARNING: Tone.CAUTION, Severity.ALARM: Tone.ALARM}


class Banner(Instrument):
    """One line over the whole width."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the most pressing alarm and how many more there are, or the next step."""
        del height
        alarm = frame.alarms.first()
        if alarm is None:
            return [fit([(" › ", Tone.NOTE), (next_step(frame), Tone.NOTE)], width)]
        spans, key = _alarm(alarm, frame.now), _key(frame, alarm)
        tone = spans[0][1]
        room = max(width - width_of(key), 0)
        return [[*fit(spans, room - 1), (" ", tone), *key] if width > 2 * width_of(key) else fit(spans, width)]


def _alarm(alarm: Alarm, now: float) -> Row:
    tone = Tone.WARN if alarm.seen else _TONES[alarm.severity]
    head = WORDS[alarm.severity] + (" seen" if alarm.seen else "")
    times = f" ×{alarm.count}" if alarm.count > 1 else ""
    if alarm.active:
        return [(f" {head}{times}  ", tone), (alarm.text, tone), (" " * 400, tone)]
    return [(f" {head} WAS{times}  ", tone), (f"{alarm.text} {span_of_time(now - alarm.ended)} ago", tone), (" " * 400, tone)]


def _key(frame: Frame, alarm: Alarm) -> list[Span]:
    """Return how many more there are, and the key that acknowledges."""
    more = sum(other.severity > Severity.INFO for other in frame.alarms.listed()) - 1
    tone = Tone.WARN if alarm.seen else _TONES[alarm.severity]
    words: list[Span] = [(f" +{more} more", tone)] if more > 0 else []
    return words if alarm.seen else [*words, (" o seen ", tone)]
