"""`groundstation evaluate` as a user runs it: real processes, stopped and killed on the way, and gone on with."""

import contextlib
import csv
import io
import os
import signal
import time
from pathlib import Path

import pytest
from evaluation_support import STEP_TOML, evaluate

from groundstation.cli import main
from groundstation.evaluation.progress import Progress

PATIENCE_S = 60.0


def lines(path):
    with contextlib.suppress(FileNotFoundError):
        return path.read_bytes().count(b"\n")
    return 0


def wait_for(condition):
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, "it did not happen"
        time.sleep(0.02)


def flying(pid):
    """Return the processes that fly for one, as the kernel has it."""
    try:
        started = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except FileNotFoundError:
        return []
    return [int(each) for each in started if "spawn_main" in command_line(each)]


def command_line(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return ""


def test_killed_it_leaves_no_process_behind_and_goes_on_where_it_was(tmp_path, monkeypatch, capsys):
    first = evaluate(tmp_path, "--seeds", "3", "--out", "r.csv", "--jobs", "2")
    wait_for(lambda: lines(tmp_path / "r.jsonl") >= 2)
    started = flying(first.pid)
    assert len(started) == 2
    first.kill()
    first.communicate()
    wait_for(lambda: not any(command_line(pid) for pid in started))
    kept = lines(tmp_path / "r.jsonl")
    assert 2 <= kept < 6
    assert not (tmp_path / "r.csv").exists()
    with (tmp_path / "r.jsonl").open("ab") as file:
        file.write(b'{"id": "cut sh')

    monkeypatch.chdir(tmp_path)
    again = ["evaluate", "--mission", "step.toml", "--rate", "250", "--seeds", "3", "--jobs", "1", "--out"]
    with pytest.raises(SystemExit) as ended:
        main([*again, "r.csv"])
    out, told = capsys.readouterr()
    assert ended.value.code == 0, told
    assert told.splitlines()[-1].startswith("6/6 flights")
    assert "\x1b" not in told + out, "it draws where there is no terminal"
    assert "assisted − paper" in out
    with (tmp_path / "r.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["controller"], row["seed"]) for row in rows] == [
        (controller, str(seed)) for seed in range(3) for controller in ("paper", "assisted")
    ]
    assert (tmp_path / "r.svg").read_text().startswith("<?xml")

    # Nothing is left to fly: another format costs nothing, and what was flown is not flown again.
    before = (tmp_path / "r.jsonl").read_bytes()
    with pytest.raises(SystemExit) as ended:
        main([*again, "r.parquet"])
    assert ended.value.code == 0
    assert capsys.readouterr().err == ""
    assert Path("r.parquet").exists()
    assert Path("r.jsonl").read_bytes() == before


def test_stopped_it_says_what_is_kept_and_how_to_go_on(tmp_path):
    running = evaluate(tmp_path, "--seeds", "50", "--out", "r.csv", "--jobs", "1")
    wait_for(lambda: lines(tmp_path / "r.jsonl") >= 1)
    started = flying(running.pid)
    running.send_signal(signal.SIGINT)
    _, told = running.communicate(timeout=PATIENCE_S)
    assert running.returncode == 130
    kept = lines(tmp_path / "r.jsonl")
    assert f"stopped: {kept} of 100 flights are kept in r.jsonl; the same command flies the rest." in told
    assert "Traceback" not in told
    wait_for(lambda: not any(command_line(pid) for pid in started))


def test_a_process_that_is_killed_ends_the_work_in_one_sentence(tmp_path):
    running = evaluate(tmp_path, "--seeds", "50", "--out", "r.csv", "--jobs", "1")
    wait_for(lambda: lines(tmp_path / "r.jsonl") >= 1)
    for pid in flying(running.pid):
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    _, told = running.communicate(timeout=PATIENCE_S)
    assert running.returncode == 1
    assert "a process that was flying was killed" in told
    assert "Traceback" not in told


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--out", "table.xlsx"), "--out table.xlsx: ends in neither .parquet nor .csv"),
        (("--out", "folder.csv"), "--out folder.csv: is a folder"),
        (("--out", "step.toml/table.csv"), "its folder cannot be made"),
        (("--jobs", "0"), "--jobs 0"),
        (("--config", "nope.toml"), "nope.toml"),
    ],
)
def test_what_cannot_be_is_told_in_one_sentence(tmp_path, monkeypatch, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    Path("folder.csv").mkdir()
    Path("step.toml").write_text(STEP_TOML)
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", "--mission", "step.toml", *arguments])
    out, told = capsys.readouterr()
    assert ended.value.code == 2
    assert words in told
    assert (told.count("\n"), out) == (1, "")


def test_without_a_terminal_a_line_comes_now_and_then():
    now = iter([0.0, 1.0, 11.0, 12.0, 13.0])
    out = io.StringIO()
    with Progress(5, 1, out, lambda: next(now)) as progress:
        for _ in range(4):
            progress.add(30.0)
    assert out.getvalue().splitlines() == ["3/5 flights, 5 × real time", "5/5 flights, 9 × real time"]


def test_on_a_terminal_it_is_a_bar_without_colours_where_none_are_wanted(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setenv("TERM", "xterm")

    def drawn():
        out = Terminal()
        with Progress(2, 0, out) as progress:
            progress.add(30.0)
        return out.getvalue()

    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "1/2" in drawn()
    assert "\x1b[3" in drawn()
    monkeypatch.setenv("NO_COLOR", "1")
    assert "1/2" in drawn()
    assert "\x1b[3" not in drawn()
