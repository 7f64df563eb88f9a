"""`groundstation missions measure`, as it is typed."""

import os
import signal
import subprocess
import sys
import time

import pytest
from operators_support import HOP_TOML

from groundstation.cli import main
from groundstation.training.mission import load_mission
from groundstation.training.reference import file_of, load_reference

COMMAND = [sys.executable, "-m", "groundstation.cli", "missions", "measure"]


def measure(folder, *options):
    return subprocess.run(
        [*COMMAND, *options], cwd=folder, capture_output=True, text=True, check=False, timeout=100
    )


def test_a_mission_is_measured_and_its_par_lies_beside_it(tmp_path):
    path = tmp_path / "hop.toml"
    path.write_text(HOP_TOML)
    done = measure(tmp_path, "hop.toml", "--seeds", "1", "--jobs", "1")
    assert (done.returncode, done.stderr.splitlines()[-1][:11]) == (0, "4/4 flights")
    assert done.stdout.splitlines()[1].startswith("hop      1/1")
    reference = load_reference(load_mission(path), path)
    assert reference is not None
    assert reference.par(0) is not None


def test_a_mission_that_cannot_be_passed_has_no_par_and_the_exit_code_says_so(tmp_path):
    path = tmp_path / "hop.toml"
    path.write_text(HOP_TOML.replace("time_limit_s = 30.0", "time_limit_s = 4.0"))
    done = measure(tmp_path, "hop.toml", "--seeds", "1", "--jobs", "1")
    assert done.returncode == 1
    assert "hop: the expert fails on seed 0: " in done.stdout
    assert not file_of(path).exists()


def test_stopped_it_ends_at_once_and_says_how_far_it_came(tmp_path):
    (tmp_path / "hop.toml").write_text(HOP_TOML)
    process = subprocess.Popen(
        [*COMMAND, "hop.toml", "--seeds", "1000", "--jobs", "1"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    assert process.stderr is not None
    assert "flights" in process.stderr.readline()
    process.send_signal(signal.SIGINT)
    began = time.monotonic()
    _, told = process.communicate(timeout=30)
    assert process.returncode == 130
    assert told.splitlines()[-1] == "stopped: 0 of 1 missions are measured."
    assert time.monotonic() - began < 30.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "or --all"),
        (("hop.toml", "--all"), "or --all"),
        (("nowhere",), "no such mission"),
        (("calm",), "nothing to measure"),
        (("hop.toml", "--seeds", "0"), "--seeds 0"),
        (("hop.toml", "--jobs", "0"), "--jobs 0"),
        (("blocked.toml",), "within 0.5 m of the pad"),
    ],
)
def test_what_cannot_be_is_told_in_one_sentence(tmp_path, monkeypatch, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hop.toml").write_text(HOP_TOML)
    post = '[[obstacle]]\nshape = "sphere"\nname = "post"\ncenter = [0.2, 0.0, 0.3]\nradius = 0.2\n'
    (tmp_path / "blocked.toml").write_text(HOP_TOML + post)
    with pytest.raises(SystemExit) as ended:
        main(["missions", "measure", *arguments])
    out, told = capsys.readouterr()
    assert ended.value.code == 2
    assert words in told
    assert (told.count("\n"), out) == (1, "")
