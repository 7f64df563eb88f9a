"""The same work on a Dask cluster: a real scheduler and two worker processes, one of which is killed."""

import csv
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from evaluation_support import STEP_TOML, task

from groundstation.cli import main
from groundstation.errors import InputError
from groundstation.evaluation.cluster import fly_on_cluster
from groundstation.evaluation.trial import fly

PATIENCE_S = 90.0
# Shows who flew, and kills the first worker that flies with it. The workers do not have this file.
CONTROLLER = """\
import os, signal
from pathlib import Path
from groundstation.pilot.controller import PaperController

FOLDER = Path({folder!r})

class Deadly(PaperController):
    def __init__(self, settings):
        super().__init__()
        if "EVALUATION_WORKER" in os.environ:
            (FOLDER / str(os.getpid())).touch()
            try:
                (FOLDER / "to kill").unlink()
            except FileNotFoundError:
                return
            os.kill(os.getpid(), signal.SIGKILL)
"""


def started(folder, *command):
    with (folder / f"{command[0]}.log").open("a") as log:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *command, "--scheduler-file", str(folder / "scheduler.json")],
            cwd=folder,
            stdout=log,
            stderr=subprocess.STDOUT,
            env=os.environ | {"EVALUATION_WORKER": "1"},
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


def test_two_workers_fly_what_one_machine_would_and_one_may_die(tmp_path, cluster, monkeypatch, capsys):
    folder, address, processes = cluster
    with pytest.raises(
        InputError, match=f"--cluster {address}: the scheduler has no workers; start some with"
    ):
        next(fly_on_cluster([task()], address))
    flew = tmp_path / "flew"
    flew.mkdir()
    (flew / "to kill").touch()
    (tmp_path / "deadly_law.py").write_text(CONTROLLER.format(folder=str(flew)))
    workers = [worker(folder), worker(folder)]
    processes += workers
    until = time.monotonic() + PATIENCE_S
    while (folder / "worker.log").read_text().count("Registered to") < 2:
        assert time.monotonic() < until, (folder / "worker.log").read_text()
        time.sleep(0.05)

    monkeypatch.chdir(tmp_path)
    given = [
        "--mission",
        "step.toml",
        "--rate",
        "250",
        "--seeds",
        "4",
        "--controller",
        "assisted,deadly_law:Deadly",
    ]
    Path("step.toml").write_text(STEP_TOML)
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", *given, "--out", "c.csv", "--cluster", address])
    out, told = capsys.readouterr()
    assert ended.value.code == 0, told
    assert "Traceback" not in told
    assert "deadly_law:Deadly − assisted" in out
    assert {int(file.name) for file in flew.iterdir()} == {each.pid for each in workers}
    assert sorted(str(each.poll()) for each in workers) == ["-9", "None"]
    with (tmp_path / "c.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 8
    assert {row["completed"] for row in rows} == {"True"}
    here = fly(task(seed=3)).outcome
    (there,) = [row for row in rows if (row["controller"], row["seed"]) == ("assisted", "3")]
    assert float(there["rms_error_m"]) == here.rms_error


def test_an_address_where_nothing_answers_is_told():
    with pytest.raises(InputError, match="no-such-scheme://x:1: no Dask scheduler answers there") as told:
        next(fly_on_cluster([task()], "no-such-scheme://x:1"))
    assert "\n" not in str(told.value)
