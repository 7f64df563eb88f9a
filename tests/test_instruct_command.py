"""`groundstation instruct` on the command line, and against a flight's bus with somebody at its other end."""

import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from recording_support import a_run

from groundstation.bus import Bus
from groundstation.cli import build_parser
from groundstation.instruct.options import fill
from groundstation.instruct.wanted import WANTED
from groundstation.messages import (
    COMMAND,
    COMMAND_ANSWER,
    EVENT,
    INTERVENTION,
    INTERVENTION_ANSWER,
    CommandAnswer,
    CommandKind,
)
from groundstation.run import write_run
from groundstation.run_folder import Stay, sweep
from groundstation.training.answering import answer_to
from groundstation.training.happening import packed, unpacked, words

ROOT = Path(__file__).resolve().parents[1]
ACTS = {
    "wind 5 -4": "wind 6.4 m/s from the north-west",
    "wind -40 40 1 --turbulence 10": "wind 56.6 m/s from the south-east, turbulence 10 m/s",
    "gust 0 -8": "gust 8.0 m/s from the north, 4 s long",
    "gust 0 -8 2 --seconds 60": "gust 8.2 m/s from the north, 60 s long",
    "delay 300": "round trip 300 ms",
    "delay 2000 --jitter 1000": "round trip 2000 ms ± 1000 ms",
    "loss 95": "95 % of frames lost",
    "loss 0": "0 % of frames lost",
    "link-loss 60": "link lost for 60 s",
    "device-loss 0.1": "haptic device lost for 0.1 s",
    "gps-loss 5": "GPS lost for 5 s",
    "battery 1": "battery down to 1 %",
    "battery 100": "battery down to 100 %",
    "calm": "all taken back",
}


@pytest.mark.parametrize("act", ACTS)
def test_what_is_typed_is_what_shall_happen(act):
    asked = build_parser().parse_args(["instruct", *act.split()])
    happening = WANTED[asked.act](asked)
    assert words(happening) == ACTS[act]
    assert unpacked(packed(happening)) == happening, "what can be typed is within what can happen"


@pytest.mark.parametrize(
    "act",
    ["wind 5", "wind 41 0", "wind nan 0", "gust 1 1 --seconds 61", "delay -1", "loss 96", "battery 0", "link-loss 0",
     "device-loss 61", "gps-loss inf", "say", "fly", "wind 1 1 --turbulence 11"],
)  # fmt: skip
def test_what_cannot_be_is_refused_in_a_line(act, capsys):
    with pytest.raises(SystemExit) as ended:
        build_parser().parse_args(["instruct", *act.split()])
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_every_act_that_lets_something_happen_has_its_words():
    import argparse

    parser = argparse.ArgumentParser()
    fill(parser)
    acts = next(each.choices for each in parser._subparsers._group_actions)
    assert {*WANTED, "say", "hold", "land", "status", "watch"} == set(acts)


def instruct(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", "instruct", *arguments],
        capture_output=True, text=True, stdin=subprocess.DEVNULL, cwd=ROOT, timeout=60, check=False,
    )  # fmt: skip


@contextmanager
def a_flight(tmp_path, why=""):
    """A flight's bus at whose other end everything is answered: done or, with `why`, refused."""
    run = a_run(tmp_path / "flight")
    write_run(run)
    stay, bus, heard, over = Stay(run.run_id), Bus(run.run_id, "link"), [], threading.Event()
    wishes, answers = bus.subscriber(INTERVENTION), bus.publisher(INTERVENTION_ANSWER)
    commands, told, events = bus.subscriber(COMMAND), bus.publisher(COMMAND_ANSWER), bus.subscriber(EVENT)

    def serve():
        while not over.is_set():
            now = time.monotonic()
            for wish in wishes.drain():
                heard.append(wish)
                answers.send(answer_to(wish, why, now))
            for command in commands.drain():
                heard.append(command)
                text = why.encode()
                told.send(
                    CommandAnswer(t=now, number=command.number, kind=command.kind, ok=not why, text=text)
                )
            heard.extend(event for event in events.drain() if event.source == b"instructor")
            answers.welcome()
            over.wait(0.01)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield run, heard
    finally:
        over.set()
        thread.join()
        bus.close()
        stay.end()
        sweep(run.run_id)


def test_an_act_is_asked_for_and_its_answer_told(tmp_path):
    with a_flight(tmp_path) as (run, heard):
        done = instruct("--run", run.run_id, "gust", "0", "-8", "--seconds", "60")
        assert (done.returncode, done.stdout, done.stderr) == (
            0,
            "Done: gust 8.0 m/s from the north, 60 s long.\n",
            "",
        )
        assert heard[0].source == b"instructor"
        found = instruct("--run", run.run_id, "status")
        assert found.returncode == 0
        assert "in force  gust 8.0 m/s from the north, 60 s long (" in found.stdout, "who comes later is told"


def test_what_is_refused_is_said_with_the_reason_and_the_exit_code(tmp_path):
    with a_flight(tmp_path, "the vehicle is real") as (run, _):
        refused = instruct("--run", run.run_id, "loss", "10")
        assert (refused.returncode, refused.stdout) == (1, "")
        assert refused.stderr == "groundstation: 10 % of frames lost: refused: the vehicle is real.\n"
        refused = instruct("--run", run.run_id, "hold")
        assert (refused.returncode, refused.stderr) == (1, "groundstation: the vehicle is real.\n")


def test_hold_and_words_reach_the_trainee_under_the_instructors_name(tmp_path):
    with a_flight(tmp_path) as (run, heard):
        assert instruct("--run", run.run_id, "hold").stdout == "Done: Hold.\n"
        assert instruct("--run", run.run_id, "say", "Look at", "the wind.").stdout == "Told.\n"
        commands = [each for each in heard if getattr(each, "kind", None) == CommandKind.HOLD]
        assert [each.source for each in commands] == [b"instructor"]
        assert commands[0].number > 1_000_000, "no number that the screen uses"
        texts = [each.text for each in heard if hasattr(each, "severity")]
        assert texts == [b"The instructor commands Hold.", b"Look at the wind."]


def test_watching_ends_with_the_flight_and_leaves_nothing_behind(tmp_path):
    with a_flight(tmp_path) as (run, _):
        watching = subprocess.Popen(
            [sys.executable, "-m", "groundstation.cli", "instruct", "--run", run.run_id, "watch"],
            stdout=subprocess.PIPE, text=True, cwd=ROOT,
        )  # fmt: skip
        assert watching.stdout.readline().startswith(f"Watching {run.run_id}")
    said, _ = watching.communicate(timeout=30)
    assert watching.returncode == 0
    assert said.endswith("The flight has ended.\n")
    assert not list(Path("/dev/shm").glob(f"*{run.run_id}*"))


@pytest.mark.parametrize(("name", "words"), [("no-such-flight", "no such flight|no flight runs")])
def test_without_such_a_flight_it_says_so(name, words):
    import re

    found = instruct("--run", name, "status")
    assert found.returncode == 2
    assert re.search(words, found.stderr)
    assert len(found.stderr.splitlines()) == 1


def test_without_act_or_terminal_it_says_what_to_do():
    found = instruct()
    assert (found.returncode, found.stdout) == (2, "")
    assert "instruct --help" in found.stderr
