"""The line of words at 80 columns: whole words, and what to do is never cut, whatever else there is to be told."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from test_tui_judge import flying, frame

from groundstation.messages import Severity
from groundstation.tui.alarms import Alarms, Condition
from groundstation.tui.rows import width_of
from groundstation.tui.widgets.banner import Banner

WIDTH = 80
ADVICE = Condition("priority", Severity.INFO, "The servo has no real-time priority.")
OTHER = Condition("link", Severity.WARNING, "The vehicle has been silent for 0.6 s.")
TEXTS = (
    "Off centre: space centres the stick, then e engages.",
    "Engage refused: the handle is not in its centre; bring it there and engage again.",
    "Engage refused: the link is still ending the last stream of setpoints; engage again",
    "The haptic device is not homed: move the handle through its whole range.",
    "Position is 1.0 s old: do not trust map or force.",
    "The vehicle may not be flown from afar: set COM_RC_IN_MODE to what is allowed; then engage once more.",
)


def line(text: str, severity: Severity, *others: Condition, muted: bool = False, width: int = WIDTH) -> str:
    alarms = Alarms()
    alarms.muted = muted
    shown = flying()
    alarms.look([*others], shown.t)
    alarms.look([*others, Condition("this", severity, text)], shown.t + 0.1)
    row = Banner().draw(replace(frame(shown), alarms=alarms), width, 1)[0]
    assert width_of(row) == width
    return "".join(part for part, _ in row)


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("severity", [Severity.WARNING, Severity.ALARM])
@pytest.mark.parametrize(("others", "muted"), [((), False), ((ADVICE,), False), ((ADVICE, OTHER), True)])
def test_words_are_whole_and_the_remedy_is_all_there(text, severity, others, muted):
    told = line(text, severity, *others, muted=muted)
    remedy = re.split(r"[:;.] ", text)[-1]
    assert remedy.lower() in told.lower()
    words = re.findall(r"[\w.,:;']+", told)
    known = {word.lower() for word in re.findall(r"[\w.,:;']+", text)}
    extra = {"alarm", "caution", "o", "seen", "b", "bell", "off", "1", "2"}
    assert {word.lower() for word in words} <= known | extra


def test_where_there_is_room_everything_is_told():
    told = line(TEXTS[1], Severity.WARNING, ADVICE, OTHER, muted=True, width=160)
    assert told.startswith(f" ▲ CAUTION  {TEXTS[1]}")
    assert told.endswith(" ▲ +1  ◇ 1  b bell off  o seen ")


def test_advice_gives_way_before_the_words_do():
    text = "Off centre: space centres the stick, then e engages, as it always did"
    told = line(text, Severity.WARNING, ADVICE)
    assert text in told
    assert "◇" not in told


def test_a_path_gives_way_before_what_is_wrong_with_it_does():
    text = "/tmp/groundstation-27993-cb8b95/hand.sock: it is silent; check the program that moves the handle."
    assert line(text, Severity.WARNING).startswith(
        " ▲  It is silent; check the program that moves the handle. "
    )


def test_one_long_clause_ends_after_a_whole_word_and_says_so():
    text = "Takeoff refused: the vehicle says that its position is not good enough to fly by yet."
    told = line(text, Severity.ALARM, width=60)
    assert told.rstrip().endswith("enough …")
