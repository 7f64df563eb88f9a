"""The same work on a Dask cluster: a real scheduler and two worker processes, one of which is killed."""

import csv
import json
import subprocess
import sys
import time

import pytest
from evaluation_support import STEP_TOML, evaluate

from groundstation.cli import main

PATIENCE_S = 90.0
# Leaves a mark where it is made, so that one sees who flew. The workers do not have this file.
CONTROLLER = """\
import os
from pathlib import Path
from groundstation.pilot.controller import PaperController

class Marked(PaperController):
    def __init__(self, settings):
        super().__init__()
        Path({marks!r}, str(os.getpid())).touch()
"""


def started(folder, *command):
    with (folder / f"{command[0]}.log").open("a") as log:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *command, "--scheduler-file", str(folder / "scheduler.json")],
            cwd=folder,
            stdout=log,
            stderr=subprocess.STDOUT,
        )


def worker(folder):
    return started(folder, "worker", "--nthreads", "1", "--no-nanny", "--no-dashboard", "--no-memory-limit")


@pytest.fixture
def cluster(tmp_path):
    """A folder, the address of the scheduler that runs in it, and what else is to be ended."""
    folder = tmp_path / "cluster"
    folder.mkdir()
    processes = [started(folder, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")]
    until = time.monotonic() + PATIENCE_S
    while not (folder / "scheduler.json").exists():
        assert time.monotonic() < until, (folder / "scheduler.log").read_text()
        time.sleep(0.05)
    address = json.loads((folder / "scheduler.json").read_text())["address"]
    yield folder, address, processes
    for process in reversed(processes):
        process.kill()
        process.wait()


def test_two_workers_fly_what_one_machine_would_and_one_may_die(tmp_path, cluster):
    folder, address, processes = cluster
    alone = evaluate(tmp_path, "--seeds", "1", "--cluster", address)
    _, told = alone.communicate(timeout=PATIENCE_S)
    assert alone.returncode == 2
    assert f"--cluster {address}: the scheduler has no workers; start some with 'dask worker ADDRESS" in told
    assert told.count("\n") == 1

    marks = tmp_path / "marks"
    marks.mkdir()
    (tmp_path / "marked_law.py").write_text(CONTROLLER.format(marks=str(marks)))
    workers = [worker(folder), worker(folder)]
    processes += workers
    until = time.monotonic() + PATIENCE_S
    while (folder / "worker.log").read_text().count("Registered to") < 2:
        assert time.monotonic() < until, (folder / "worker.log").read_text()
        time.sleep(0.05)

    given = ("--controller", "assisted,marked_law:Marked", "--seeds", "4", "--out", "c.csv")
    running = evaluate(tmp_path, *given, "--cluster", address)
    flew = {str(each.pid) for each in workers}
    while not flew <= {mark.name for mark in marks.iterdir()}:
        assert running.poll() is None, running.communicate()
        assert time.monotonic() < until
        time.sleep(0.02)
    workers[0].kill()
    out, told = running.communicate(timeout=PATIENCE_S)
    assert running.returncode == 0, told
    assert "Traceback" not in told
    assert "marked_law:Marked − assisted" in out
    with (tmp_path / "c.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 8
    assert {row["completed"] for row in rows} == {"True"}


def test_an_address_where_nothing_answers_is_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "step.toml").write_text(STEP_TOML)
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", "--mission", "step.toml", "--seeds", "1", "--cluster", "no-such-scheme://x:1"])
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert "no Dask scheduler answers there" in told
    assert told.count("\n") == 1
