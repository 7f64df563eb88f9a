"""`groundstation progress`: as a person and as a program use it, against a real store and real recordings."""

from __future__ import annotations

import datetime
import json
import lzma
import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from groundstation.cli import main
from groundstation.progress.flown import Flown
from groundstation.progress.judging import device_word
from groundstation.progress.opening import store_in
from groundstation.progress.store import Store
from groundstation.progress.words import trend

RECORDING = Path(__file__).parent / "recordings" / "flight_v1.rrd.xz"


@pytest.fixture
def logs(tmp_path) -> Path:
    today = datetime.datetime.now().astimezone()
    with Store(store_in(tmp_path)) as store:
        for number, (mission, points, passed) in enumerate(
            [
                ("spring", 60.0, True),
                ("spring", 90.0, True),
                ("hover", 30.0, False),
                ("check-ride", 81.0, True),
            ]
        ):
            started = (today - datetime.timedelta(days=9, minutes=-number)).isoformat()
            measures = {"collisions": 1.0, "time_s": 100.0}
            store.add(
                Flown(
                    "Ann",
                    mission,
                    "d",
                    started,
                    passed=passed,
                    points=points,
                    duration_s=100.0,
                    simulated=number != 1,
                    measures=measures,
                    recording=f"{number}.rrd",
                )
            )
        store.add(Flown("Bob", "hover", "d", today.isoformat(), passed=False, points=12.0, duration_s=30.0))
    return tmp_path


def said(capsys, *words: object) -> tuple[int, str, str]:
    """Return exit code, stdout and stderr of a command."""
    with pytest.raises(SystemExit) as end:
        main(["progress", *map(str, words)])
    out, err = capsys.readouterr()
    return int(end.value.code or 0), out, err


def test_a_table_for_people(capsys, logs):
    code, out, err = said(capsys, "--pilot", "ann", "--logs", logs)
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert lines[0].startswith("Ann: ")
    assert "2 of 23 missions passed, 7 min in 4 flights." in lines[0]
    assert lines[1].startswith("Next: ")
    (spring,) = [line for line in lines if line.split()[1:2] == ["spring"] and "▅" in line]
    assert spring.split()[:6] == ["▸", "spring", "1", "90", "90", "▅▇"]
    assert spring.endswith("due")
    assert max(map(len, lines)) <= 80
    assert all(ord(sign) >= 32 for line in lines for sign in line)


def test_an_object_for_programs(capsys, logs):
    code, out, _ = said(capsys, "--pilot", "Ann", "--logs", logs, "--json")
    found = json.loads(out)
    assert code == 0
    assert (found["pilot"], found["passed"], found["flights"], found["collisions"]) == (
        "Ann",
        2,
        4,
        4,
    )
    spring = next(each for each in found["missions"] if each["mission"] == "spring")
    assert (spring["best"], spring["points"], spring["overdue"]) == (90.0, [60.0, 90.0], True)
    assert found["next"]["mission"] in {each["mission"] for each in found["missions"] if each["open"]}


def test_everybody(capsys, logs):
    code, out, _ = said(capsys, "pilots", "--logs", logs)
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == ["pilot", "Ann", "Bob"]
    _, out, _ = said(capsys, "pilots", "--json", "--logs", logs)
    assert json.loads(out)["Bob"]["flights"] == 1


@pytest.mark.parametrize("act", [["--pilot", "Cid"], ["certificate", "Cid"], ["forget", "Cid"]])
def test_who_is_not_known_is_told_who_is(capsys, logs, act):
    code, out, err = said(capsys, *act, "--logs", logs)
    assert (code, out) == (2, "")
    assert err == f"groundstation: Cid: has no flights in {logs}; known: Ann, Bob.\n"


def test_to_look_makes_no_file(capsys, tmp_path):
    assert said(capsys, "--logs", tmp_path)[0] == 0
    assert said(capsys, "pilots", "--logs", tmp_path / "none")[1].startswith("Nobody has flown")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", ["html", "md", "pdf"])
def test_a_certificate_tells_what_was_passed_and_that_it_is_no_licence(capsys, logs, suffix):
    file = logs / f"ann.{suffix}"
    code, out, _ = said(capsys, "certificate", "Ann", "--logs", logs, "--out", file)
    assert (code, out) == (0, f"{file}\n")
    content = file.read_bytes()
    if suffix == "pdf":
        assert content.startswith(b"%PDF")
        assert len(content) > 10_000
        return
    words = content.decode()
    for expected in (
        "Ann",
        "2 of 23",
        "best 81 of 100 in 1 ride",
        "It is no licence",
        "Feel the spring",
        "2 min",
    ):
        assert expected in words
    assert "Bob" not in words
    assert "Hover: to a point" not in words


@pytest.mark.parametrize("suffix", ["html", "md", "pdf"])
def test_a_pilot_s_name_is_words_and_nothing_that_a_reader_runs(capsys, tmp_path, suffix):
    name = r"<img src=x onerror=alert(1)> $\frac{1}$ | \input{/etc/passwd}"
    with Store(store_in(tmp_path)) as store:
        day = datetime.datetime.now().astimezone().isoformat()
        store.add(Flown(name, "hover", "d", day, passed=False, points=12.0, duration_s=30.0))
    file = tmp_path / f"sheet.{suffix}"
    assert said(capsys, "certificate", name, "--logs", tmp_path, "--out", file)[0] == 0
    content = file.read_bytes()
    if suffix == "pdf":
        # No formula is set, and nothing runs in a PDF's strings.
        assert content.startswith(b"%PDF")
    else:
        assert b"<img" not in content
        assert b"&lt;img src=x" in content


def test_a_certificate_of_another_kind_or_to_nowhere_is_refused(capsys, logs):
    assert ".pdf, .html, .md" in said(capsys, "certificate", "Ann", "--logs", logs, "--out", "a.doc")[2]
    code, _, err = said(capsys, "certificate", "Ann", "--logs", logs, "--out", logs / "no" / "a.md")
    assert code == 2
    assert "cannot be written" in err


def test_to_forget_asks_back_and_tells_of_recordings_that_bear_the_name(capsys, logs):
    (logs / "1.rrd").touch()
    code, _, err = said(capsys, "forget", "ann", "--logs", logs)
    assert (code, "add --yes" in err) == (2, True)
    code, out, _ = said(capsys, "forget", "ann", "--yes", "--logs", logs)
    assert code == 0
    assert "Ann: 4 flights removed from the store." in out
    assert "1 recording in" in out
    assert "  1.rrd" in out
    assert "0.rrd" not in out
    with Store(store_in(logs)) as store:
        assert store.pilots() == ["Bob"]


@pytest.mark.parametrize(("typed", "code", "left"), [("ANN", 0, ["Bob"]), ("Bob", 1, ["Ann", "Bob"])])
def test_on_a_terminal_the_name_is_typed(logs, typed, code, left):
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "groundstation.cli", "progress", "forget", "Ann", "--logs", str(logs)]
    with subprocess.Popen(command, stdin=theirs, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        os.close(theirs)
        os.write(ours, f"{typed}\n".encode())
        process.communicate(timeout=60)
    os.close(ours)
    assert process.returncode == code
    with Store(store_in(logs)) as store:
        assert store.pilots() == left


def test_a_recording_of_the_scripted_hand_is_nobodys_progress(capsys, tmp_path):
    """It was recorded when such flights bore the name of who was logged in."""
    (tmp_path / "old.rrd").write_bytes(lzma.decompress(RECORDING.read_bytes()))
    (tmp_path / "broken.rrd").write_bytes(b"no recording")
    code, out, err = said(capsys, "import", tmp_path / "old.rrd", "--logs", tmp_path)
    assert (code, out, err) == (0, "0 flights added, 0 known already, from 1 recording.\n", "")
    code, _, err = said(capsys, "import", tmp_path / "broken.rrd", "--logs", tmp_path)
    assert code == 1
    assert "is not a Rerun recording" in err
    code, _, err = said(capsys, "import", "--logs", tmp_path / "none")
    assert (code, "there is no such folder" in err) == (2, True)


def test_a_damaged_store_is_told_of_and_the_answer_comes(capsys, logs):
    store_in(logs).write_bytes(b"nothing of a database" * 50)
    code, out, err = said(capsys, "pilots", "--logs", logs)
    assert (code, "Nobody has flown" in out) == (0, True)
    assert "was damaged and is now progress.sqlite.damaged-" in err


def test_a_trend_is_the_last_points_a_sign_each():
    assert trend([]) == ""
    assert trend([0.0, 50.0, 100.0, 120.0, -3.0]) == "▁▅██▁"
    assert len(trend([50.0] * 20)) == 8


def test_a_device_is_named_without_the_socket_of_its_run():
    assert device_word("virtual:/tmp/groundstation-1-abc/hand.sock") == "virtual"
    assert device_word("emulated:falcon@/tmp/groundstation-1-abc/hand.sock") == "emulated:falcon"
    assert device_word("falcon:0") == "falcon:0"
