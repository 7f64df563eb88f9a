"""The course as lines of text: each mission with its state, its trend and when it is due."""

from __future__ import annotations

from rich.style import Style
from rich.text import Text

from groundstation.progress.desk import Report
from groundstation.progress.skills import Record
from groundstation.progress.words import NEXT, PASSED, counted, due_words, hours, mark, number, trend
from groundstation.tui.rows import shortened
from groundstation.tui.theme import Tone

_NAME, _TREND, _DUE = 12, 8, 28
# From here on the title stands beside the name.
_WIDE = 100

Styles = dict[Tone, Style]


def head(report: Report, styles: Styles) -> Text:
    """Return who flies, how they stand, and what comes next and why, in two lines."""
    standing, flown = report.standing, sum(each.duration_s for each in report.flights)
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(f" {report.pilot or 'nobody named'} ", styles[Tone.CHIP_HAND])
    text.append(f"  {standing.passed} of {len(standing.records)} passed", styles[Tone.STRONG])
    text.append(f", {counted(len(report.flights), 'flight')}, {hours(flown)}", styles[Tone.MUTED])
    if weakest := standing.weakest:
        text.append(f", weakest: {weakest} {standing.levels[weakest]:.0f}", styles[Tone.MUTED])
    if standing.next:
        text.append(f"\n {NEXT} {standing.next.mission}", styles[Tone.KEY])
        text.append(f"  {standing.next.why}", styles[Tone.TEXT])
    return text


def columns(width: int, styles: Styles) -> Text:
    """Return the heads of the columns of `line`."""
    title = f"{'':<{_title_width(width)}}"
    return Text(
        f"   {'mission':<{_NAME}} {title}{'lvl':>3} {'best':>4} {'trend':<{_TREND}}  due",
        styles[Tone.MUTED],
        no_wrap=True,
    )


def line(record: Record, report: Report, width: int, styles: Styles) -> Text:
    """Return a mission in a line of a width."""
    standing = report.standing
    following = standing.next.mission if standing.next else None
    sign = mark(record, following)
    tone = {NEXT: Tone.KEY, PASSED: Tone.OK}.get(sign, Tone.TEXT if record.open else Tone.FAINT)
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(f" {sign} ", styles[tone])
    text.append(f"{record.mission.name:<{_NAME}} ", styles[tone])
    room = _title_width(width)
    text.append(
        f"{shortened(record.mission.title, room - 1):<{room}}",
        styles[Tone.TEXT if record.open else Tone.FAINT],
    )
    text.append(f"{record.mission.level:>3} ", styles[Tone.MUTED])
    text.append(f"{number(record.best):>4} ", styles[Tone.STRONG])
    text.append(f"{trend(record.points, _TREND):<{_TREND}}  ", styles[Tone.VEHICLE])
    due = due_words(record, report.today)
    text.append(due, styles[Tone.WARN if record.due(report.today) else Tone.MUTED])
    return text


def _title_width(width: int) -> int:
    fixed = 3 + _NAME + 1 + 4 + 5 + _TREND + 2 + _DUE
    return width - fixed if width >= _WIDE else 0
