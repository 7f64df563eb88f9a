"""The line of words: the most pressing that is wrong, or what to do next."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from groundstation.messages import Severity
from groundstation.tui.alarms import Alarm, Alarms
from groundstation.tui.frame import Frame
from groundstation.tui.hints import next_step
from groundstation.tui.rows import Row, fit, span_of_time, wrapped
from groundstation.tui.theme import MARKS, PRIORITIES, Tone
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
            tone, lefts = Tone.NOTE, [f"› {next_step(frame)}"]
        else:
            tone, lefts = (
                Tone.WARN if alarm.seen else _TONES[alarm.severity],
                list(_ever_shorter(alarm, frame.now)),
            )
        left, right = _fitting(lefts, _right(frame.alarms, alarm), width)
        room = max(width - len(right), 0)
        return [[*fit([(f" {left}", tone), (" " * room, tone)], room), (right, tone)]]


def _fitting(lefts: list[str], rights: list[str], width: int) -> tuple[str, str]:
    """Return the first of words and counters, each in ever shorter forms, that fit; at last the words' beginning.

    Rather than the last form of the words, which leaves out most, no counter is shown.
    """
    *forms, last = lefts
    pairs = [(left, right) for right in rights for left in forms] + [(last, right) for right in rights]
    for left, right in pairs:
        if 1 + len(left) + len(right) <= width:
            return left, right
    head, *more = wrapped(last, max(width - 3, 1))
    return f"{head} …" if more else head, rights[-1]


def headline(alarm: Alarm, now: float, sign: str = "") -> str:
    """Return an alarm in a line: its priority or a sign, how often, whether it is over or seen, and what it is."""
    times = f" ×{alarm.count}" if alarm.count > 1 else ""
    seen = " seen" if alarm.seen else ""
    over = "" if alarm.active else f" {span_of_time(now - alarm.ended)} ago"
    return f"{sign or PRIORITIES[alarm.severity]}{times}{seen}{over}  {alarm.text}"


def _ever_shorter(alarm: Alarm, now: float) -> Iterator[str]:
    """Yield an alarm in a line: as it is, without what was refused, without the word that its mark says as well.

    At last only what to do is left, for that is what must fit.
    """
    yield headline(alarm, now)
    brief = replace(alarm, text=_reason(alarm.text))
    yield headline(brief, now)
    mark = MARKS[alarm.severity]
    yield headline(brief, now, mark)
    # Of whom it is said, where that is only a path.
    for words in (re.sub(r"^/[^ ]*: ", "", brief.text), re.split(r"[:;.] ", brief.text)[-1]):
        yield headline(replace(alarm, text=_capital(words)), now, mark)


def _reason(text: str) -> str:
    """Return a refusal's reason without what was refused."""
    said, _, reason = text.partition(" refused: ")
    return _capital(reason) if reason else said


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _right(alarms: Alarms, shown: Alarm | None) -> list[str]:
    """Return how many more there are, the key that acknowledges, and whether the bell is muted; then less of it."""
    listed = alarms.listed()
    serious = sum(alarm is not shown and alarm.severity > Severity.INFO for alarm in listed)
    advice = sum(alarm is not shown and alarm.severity is Severity.INFO for alarm in listed)
    more = [f"▲ +{serious}"] if serious else []
    seen = ["o seen"] if shown is not None and not shown.seen else []
    advised = [f"◇ {advice}"] if advice else []
    muted = ["b bell off"] if alarms.muted else []
    forms = ([*more, *advised, *muted, *seen], [*more, *muted, *seen], [*more, *seen], more, [])
    return [f" {'  '.join(words)} " if words else "" for words in forms]
