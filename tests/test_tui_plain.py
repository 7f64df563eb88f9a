"""A flight in words: the line of status, the commands, what is asked back, and a whole flight through pipes."""

from __future__ import annotations

import os
import queue
import re
import subprocess
import sys
import threading
import time
from dataclasses import replace

import pytest
from canned_flight import NOTHING, CannedFlight, CannedReader, CannedSupervisor, canned_run

from groundstation.messages import CommandKind, Event, FlightMode, Preset, Severity
from groundstation.pilot.choices import ALL_CUES
from groundstation.tui.acts import ACTS
from groundstation.tui.choices import CHOICES
from groundstation.tui.hand import Hand
from groundstation.tui.plain import PlainFlight
from groundstation.tui.plain_words import HELP
from groundstation.tui.ways import KEYS, WORDS, Ways

GROUND, ARMED, AIR, ENGAGED = 0.3, 0.8, 4.0, 17.0


class Words:
    """A flight in words with its doubles."""

    def __init__(self, seconds: float | None, *, simulated: bool = True, stick: bool = True) -> None:
        run = canned_run(simulated=simulated)
        flight = CannedFlight(run)
        flight.advance(seconds or 0.0)
        self.reader = CannedReader(NOTHING if seconds is None else flight.snapshot())
        self.said: list[str] = []
        self.hand = Hand() if stick else None
        self.flight = PlainFlight(run, self.reader, CannedSupervisor(), self.said.append, self.hand)
        self.flight.turn()

    def later(self, seconds: float) -> None:
        self.reader.shown = replace(self.reader.shown, t=self.reader.shown.t + seconds)
        self.flight.turn()

    def hear(self, *typed: str) -> list[CommandKind]:
        for words in typed:
            self.flight.hear(words)
        return self.reader.commands


@pytest.mark.parametrize(
    ("seconds", "typed", "kind"),
    [
        (GROUND, "arm", CommandKind.ARM),
        (ARMED, "disarm", CommandKind.DISARM),
        (ARMED, "take off", CommandKind.TAKEOFF),
        (ARMED, "takeoff", CommandKind.TAKEOFF),
        (AIR, "Engage", CommandKind.ENGAGE),
        (ENGAGED, "release", CommandKind.DISENGAGE),
        (ENGAGED, "disengage", CommandKind.DISENGAGE),
        (ENGAGED, "hold", CommandKind.HOLD),
        (ENGAGED, " return ", CommandKind.RETURN),
        (ENGAGED, "land", CommandKind.LAND),
    ],
)
def test_a_word_does_its_act_on_the_simulated_vehicle(seconds, typed, kind):
    assert Words(seconds).hear(typed) == [kind]


def test_what_is_not_possible_is_said_and_not_sent():
    words = Words(GROUND)
    assert words.hear("land", "engage", "nonsense") == []
    assert words.said[-3:] == [
        "Land: it is not in the air.",
        "Engage: take off first.",
        "nonsense: is no command; 'help' lists them.",
    ]


def test_a_real_vehicle_is_asked_about():
    words = Words(GROUND, simulated=False)
    assert words.hear("arm", "no") == []
    assert words.said[-1] == "Not confirmed: nothing was done."
    assert words.hear("arm", "yes") == [CommandKind.ARM]


@pytest.mark.parametrize("typed", ["REAL", "1"])
def test_the_first_engagement_of_a_real_vehicle_takes_more_than_a_yes(typed):
    words = Words(AIR, simulated=False)
    assert words.hear("engage", "yes") == []
    assert words.hear("engage", typed, "engage") == [CommandKind.ENGAGE] * 2


def test_kill_is_asked_back_and_runs_out():
    words = Words(ENGAGED)
    words.hear("kill")
    words.later(3.1)
    assert words.said[-2] == "Not confirmed: nothing was done."
    assert words.hear("yes", "kill", "kill") == []
    assert words.hear("kill", "yes") == [CommandKind.KILL]


def test_what_makes_things_safer_answers_any_question():
    assert Words(ENGAGED).hear("kill", "hold") == [CommandKind.HOLD]


def test_choices_go_on_or_are_named():
    words = Words(ENGAGED)
    words.hear("mapping", "preset paper", "position", "fine", "preset nonsense", "fine 3")
    sent = list(zip(words.reader.commands, words.reader.values, strict=True))
    assert sent == [
        (CommandKind.MAPPING, 1),
        (CommandKind.PRESET, Preset.PAPER),
        (CommandKind.CUES, ALL_CUES - 1),
        (CommandKind.FINE, 1),
    ]
    assert "assisted" in words.said[-2]


def test_the_stick_is_moved_and_centred():
    words = Words(ENGAGED)
    words.hear("stick 40 -20 0 300")
    assert words.hand.share == pytest.approx((0.4, -0.2, 0.0, 1.0))
    words.hear("stick a", "stick 1 2 3")
    assert words.hand.share == pytest.approx((0.4, -0.2, 0.0, 1.0))
    words.hear("centre")
    assert words.hand.share == (0.0, 0.0, 0.0, 0.0)


def test_with_another_device_there_is_no_stick():
    words = Words(ENGAGED, stick=False)
    words.hear("stick 10 0 0 0")
    assert "is no command" in words.said[-1]


def test_quitting_in_the_air_asks_and_leaves_a_coupled_vehicle_holding():
    words = Words(ENGAGED)
    words.hear("quit", "no")
    assert not words.flight.left
    assert words.hear("quit", "yes") == [CommandKind.HOLD]
    assert words.flight.left
    ground = Words(GROUND)
    assert ground.hear("quit") == []
    assert ground.flight.left


def test_the_line_has_state_figures_with_units_and_what_is_next():
    (line,) = (said for said in Words(ENGAGED).said if " SIM " in said)
    for part in (
        "OFFBOARD",
        "armed",
        "in the air",
        "ENGAGED",
        "altitude 2.",
        " m/s",
        " N,",
        "battery 84 %",
        "Engaged.",
    ):
        assert part in line
    assert "REAL" in Words(GROUND, simulated=False).said[-1]
    assert "no vehicle" in Words(None).said[-1]


def test_a_line_comes_once_a_second_or_at_once_on_a_change_and_never_twice_the_same():
    words = Words(ENGAGED)
    count = len(words.said)
    words.later(0.5)
    assert len(words.said) == count
    words.reader.shown.status.mode = FlightMode.HOLD
    words.later(0.05)
    assert len(words.said) == count + 1
    assert "HOLD" in words.said[-1]


def test_events_are_told_once_with_their_severity():
    words = Words(ENGAGED)
    shown = words.reader.shown
    event = Event(t=shown.t + 0.01, severity=Severity.ALARM, source=b"link", text=b"Lost.")
    words.reader.shown = replace(shown, t=shown.t + 0.1, events=(*shown.events, event))
    words.flight.turn()
    words.flight.turn()
    assert [said.partition(" ")[2] for said in words.said].count("ALARM: link: Lost.") == 1


def test_help_and_checks_name_everything():
    assert all(act.label.lower() in HELP for act in ACTS)
    assert all(choice.name in HELP for choice in CHOICES)
    words = Words(GROUND)
    words.hear("checks")
    assert any(said.startswith("■ COM_OF_LOSS_T: not read") for said in words.said)
    assert any(said.startswith("ok link:") for said in words.said)


class Piped:
    """The program with pipes for a terminal."""

    def __init__(self, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "groundstation.cli", *arguments],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env=os.environ | {"NO_COLOR": "1"},
        )  # fmt: skip
        self.lines: queue.Queue[str] = queue.Queue()
        self.said: list[str] = []
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for line in self.process.stdout:
            self.lines.put(line)

    def say(self, words: str) -> None:
        self.process.stdin.write(words + "\n")
        self.process.stdin.flush()

    def until(self, part: str, within_s: float = 40.0) -> None:
        end = time.monotonic() + within_s
        while time.monotonic() < end:
            try:
                self.said.append(self.lines.get(timeout=0.2))
            except queue.Empty:
                continue
            if part in self.said[-1]:
                return
        pytest.fail(f"{part!r} was not said:\n{''.join(self.said)}")


@pytest.mark.flight
@pytest.mark.timeout(180)
def test_a_whole_flight_in_words_without_a_terminal(tmp_path):
    flight = Piped("--sim", "--plain", "--logs", str(tmp_path))
    try:
        flight.until("Ready on the ground")
        flight.say("arm")
        flight.until("Armed on the ground")
        flight.say("take off")
        flight.until("HOLD, armed, in the air")
        flight.say("engage")
        flight.until("ENGAGED")
        flight.say("stick 0 0 50 0")
        flight.until("altitude 3.")
        flight.say("hold")
        flight.until("released")
        flight.say("land")
        flight.until("disarmed, on the ground")
        flight.say("quit")
        assert flight.process.wait(30) == 0
    finally:
        flight.process.kill()
        flight.process.wait()
        flight.process.stdin.close()
        flight.process.stdout.close()
    assert list(tmp_path.glob("*.rrd"))


def test_hints_ask_for_words_that_are_known_here_and_for_keys_that_are_known_on_the_screen():
    known = [*ACTS, *CHOICES]
    for name in set(Ways._fields) - {"centre", "pushed"}:
        assert getattr(KEYS, name).removeprefix("Shift+") in {each.key for each in known if each.name == name}
        typed = getattr(WORDS, name).strip("'")
        assert typed in {
            word for each in known if each.name == name for word in (each.name, each.label.lower())
        }
    words = Words(ENGAGED)
    words.hear("stick 40 0 0 0", WORDS.centre.strip("'"))
    assert words.hand.share == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("seconds", [GROUND, ARMED, AIR, ENGAGED])
def test_no_hint_asks_for_a_key(seconds):
    asked = " ".join(Words(seconds).said)
    assert re.search(r"'(arm|take off|engage|release)' (arms|takes off|engages|releases)", asked)
    assert not re.search(r"Shift\+|\b[a-z] (takes|engages|releases|lands|holds|clutches)", asked)
