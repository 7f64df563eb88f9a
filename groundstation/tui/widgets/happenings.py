"""What is wrong now, the most pressing first, and below it the latest events, newest at the bottom."""

from __future__ import annotations

from groundstation.messages import Severity
from groundstation.tui.alarms import Alarm
from groundstation.tui.frame import Frame
from groundstation.tui.notes import Note, merged
from groundstation.tui.rows import Row, clock, fit, wrapped
from groundstation.tui.theme import MARKS, TONES, Tone
from groundstation.tui.widgets.banner import headline
from groundstation.tui.widgets.instrument import Instrument

_WITH_SOURCE = 60
_LOW = 4
# Of the rows at most this share is for alarms.
_ALARMS_SHARE = 0.4
_ALARM_TONES = {Severity.INFO: Tone.NOTE, Severity.WARNING: Tone.WARN, Severity.ALARM: Tone.ALARM}


class Happenings(Instrument):
    """Lines of time, mark and words; long ones go on in the next line."""

    BORDER_TITLE = "events"
    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the newest that fit."""
        alarms = [] if height <= _LOW else frame.alarms.listed()[: int(_ALARMS_SHARE * height)]
        head = [_alarm(alarm, frame.now, width) for alarm in alarms]
        if head:
            head.append([("─" * width, Tone.GRID)])
            height -= len(head)
        notes = merged(frame.snapshot.events, frame.notes, height)
        rows: list[Row] = []
        for note in notes:
            lines = _lines(note, note.t - frame.started, width)
            # In a low pane only the newest may take more than its line.
            brief = height <= _LOW and note is not notes[-1] and len(lines) > 1
            rows.extend([[*lines[0][:-1], (f"{lines[0][-1][0]} …", lines[0][-1][1])]] if brief else lines)
        return [*head, *(rows[-height:] if rows else [[(" nothing yet", Tone.FAINT)]])]


def _alarm(alarm: Alarm, now: float, width: int) -> Row:
    """Return an alarm as a line: what lasts stands out, what is seen or over does not."""
    calm = alarm.seen or not alarm.active
    tone = Tone.MUTED if calm else _ALARM_TONES[alarm.severity]
    return fit([(f" {headline(alarm, now)}", tone)], width)


def _lines(note: Note, t: float, width: int) -> list[Row]:
    tone = Tone.TEXT if note.severity is Severity.INFO else TONES[note.severity]
    source = f"{note.source:<8} " if width >= _WITH_SOURCE else ""
    head = f" {clock(t)} "
    room = max(width - len(head) - 4 - len(source), 10)
    pieces = wrapped(note.text, room)
    first: Row = [
        (head, Tone.MUTED),
        (f"{MARKS[note.severity]} ", TONES[note.severity]),
        (source, Tone.MUTED),
    ]
    rows: list[Row] = [[*first, (pieces[0], tone)]]
    indent = " " * (len(head) + 2 + len(source))
    rows.extend([(indent, Tone.TEXT), (piece, tone)] for piece in pieces[1:])
    return rows
