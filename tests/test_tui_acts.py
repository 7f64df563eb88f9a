"""What can be asked for when, and what becomes of it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from canned_flight import NOTHING, START, CannedFlight, canned_run

from groundstation.messages import CommandAnswer, CommandKind, Event, Severity
from groundstation.tui.acts import ACTS, BY_NAME, URGENT
from groundstation.tui.choices import CHOICES
from groundstation.tui.notes import ANSWER_S, Answers, Note, from_event, merged, words
from groundstation.tui.pages import PAGES
from groundstation.tui.screens.flight import STEPS


def possible(seconds: float) -> set[str]:
    """Return what can be done at a moment of the canned flight."""
    flight = CannedFlight(canned_run())
    flight.advance(seconds)
    snapshot = flight.snapshot()
    return {act.name for act in ACTS if not act.hindrance(snapshot)}


def test_before_anything_came_nothing_can_be_done():
    assert {act.name for act in ACTS if not act.hindrance(NOTHING)} == set()


@pytest.mark.parametrize(
    ("seconds", "acts"),
    [
        (0.3, {"arm"}),
        (0.8, {"disarm", "takeoff", "kill"}),
        (3.0, {"engage", "hold", "return", "land", "kill"}),
        (8.0, {"disengage", "hold", "return", "land", "kill"}),
    ],
)
def test_what_can_be_done_follows_the_flight(seconds, acts):
    assert possible(seconds) == acts


def test_a_silent_link_takes_no_urgent_act_away():
    flight = CannedFlight(canned_run())
    flight.advance(8.0)
    snapshot = flight.snapshot()
    snapshot.status.connected = 0
    late = replace(snapshot, t=snapshot.t + 60.0)
    assert all(not act.hindrance(late) for act in ACTS if act.urgent)


def test_without_a_pilot_nothing_engages():
    flight = CannedFlight(canned_run())
    flight.advance(3.0)
    snapshot = flight.snapshot()
    assert BY_NAME["engage"].hindrance(snapshot) == ""
    for silent in (replace(snapshot, pilot=None), replace(snapshot, t=snapshot.t + 1.0)):
        assert BY_NAME["engage"].hindrance(silent) == "the pilot process does not answer"


def test_without_a_device_nothing_engages():
    flight = CannedFlight(canned_run())
    flight.advance(3.0)
    snapshot = flight.snapshot()
    snapshot.device.homed = 0
    assert "not homed" in BY_NAME["engage"].hindrance(snapshot)
    snapshot.device.present = 0
    assert "no haptic device" in BY_NAME["engage"].hindrance(snapshot)
    assert "no haptic device" in BY_NAME["engage"].hindrance(replace(snapshot, device=None))


def test_every_command_is_an_act_or_a_choice_and_no_two_share_a_key():
    acts, choices = {act.kind for act in ACTS}, {choice.kind for choice in CHOICES}
    # The pages of parameters and settings send the rest.
    others = {CommandKind.PARAMETERS, CommandKind.SET_PARAMETER, CommandKind.SETTINGS}
    assert acts | choices | others == set(CommandKind)
    assert not acts & choices
    keys = [key for asked in (*ACTS, *CHOICES) for key in asked.keys]
    keys += [key for key, *_ in STEPS] + ["0", "q", "Q", "f1"]
    keys += [act.everywhere for act in URGENT] + [page.key for page in PAGES]
    assert len(keys) == len(set(keys))


def answered(*, ok: int, text: bytes = b"", number: int = 1, t: float = START):
    return replace(
        NOTHING, t=t, answers=(CommandAnswer(number=number, kind=CommandKind.ARM, ok=ok, text=text),)
    )


def test_a_refusal_is_told_with_its_reason_an_acceptance_is_not():
    answers = Answers()
    answers.sent(1, CommandKind.ARM, START)
    assert [note.text for note in answers.take(answered(ok=0, text=b"the battery is low"))] == [
        "Arm refused: the battery is low."
    ]
    answers.sent(1, CommandKind.ARM, START)
    assert answers.take(answered(ok=1)) == []


def test_a_refusal_that_says_so_itself_is_not_said_twice():
    answers = Answers()
    answers.sent(1, CommandKind.ARM, START)
    assert answers.take(answered(ok=0, text=b"Arm refused: no."))[0].text == "Arm refused: no."


def test_an_answer_to_another_console_is_none_of_ours():
    answers = Answers()
    answers.sent(1, CommandKind.ARM, START)
    assert answers.take(answered(ok=0, number=7)) == []


def test_a_command_nobody_answers_is_told_once():
    answers = Answers()
    answers.sent(1, CommandKind.HOLD, START)
    assert answers.take(replace(NOTHING, t=START + ANSWER_S - 0.1)) == []
    (note,) = answers.take(replace(NOTHING, t=START + ANSWER_S + 0.1))
    assert note.severity is Severity.ALARM
    assert "no answer" in note.text
    assert answers.take(replace(NOTHING, t=START + 60.0)) == []


def test_lines_are_merged_by_time_and_the_same_words_are_said_once():
    events = [
        Event(t=START + at, severity=Severity.INFO, source=b"link", text=text)
        for at, text in ((1, b"one"), (3, b"three"))
    ]
    notes = [
        Note(START + 2, Severity.INFO, "screen", "two"),
        Note(START + 3.2, Severity.INFO, "screen", "three"),
    ]
    assert [line.text for line in merged(events, notes, 9)] == ["one", "two", "three"]
    assert [line.text for line in merged(events, notes, 2)] == ["two", "three"]
    assert merged(events, notes, 0) == []


def test_what_others_wrote_cannot_move_the_cursor_and_any_severity_is_read():
    assert words(b"a\x1b[2Jb\nc\xff") == "a [2Jb c\ufffd"
    assert from_event(Event(t=START, severity=77, source=b"x", text=b"odd")).severity is Severity.WARNING
