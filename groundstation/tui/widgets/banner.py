"""The line of words: the most urgent that is wrong, and how much more is; else what to do next."""

from __future__ import annotations

from groundstation.messages import Severity
from groundstation.tui.alarms import PRIORITIES, Alarm
from groundstation.tui.alerts import next_step
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, spread
from groundstation.tui.theme import MARKS, TONES, Tone
from groundstation.tui.widgets.instrument import Instrument

_NEW = {Severity.INFO: Tone.NOTE, Severity.WARNING: Tone.CAUTION, Severity.ALARM: Tone.ALARM}


class Banner(Instrument):
    """One line over the whole width; a reversed one is new, Enter takes it as known."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the most urgent, or the next step."""
        del height
        if not frame.alarms:
            return [[(" › ", Tone.NOTE), (next_step(frame), Tone.NOTE)]]
        first = frame.alarms[0]
        new = not first.rank[0]
        tone = _NEW[first.severity] if new or first.severity is Severity.INFO else TONES[first.severity]
        words = f" {_mark(first)} {PRIORITIES[first.severity]}  {first.text} "
        keys = _keys(frame, len(frame.alarms) - 1, new=new)
        # What is new is reversed over the whole width.
        return [spread([(words, tone)], [(keys, tone)], width, tone if new else Tone.TEXT)]


def _mark(alarm: Alarm) -> str:
    return "›" if alarm.severity is Severity.INFO else MARKS[alarm.severity]


def _keys(frame: Frame, more: int, *, new: bool) -> str:
    parts = [f"+{more}"] if more else []
    parts += ["Enter: seen"] if new else []
    parts += ["bell off"] if frame.muted else ["u: bell off"] if new else []
    return f"{'  '.join(parts)} " if parts else ""
