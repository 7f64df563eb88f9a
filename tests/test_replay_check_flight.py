"""A real flight, all processes in real time, recorded by the real recorder: its pilot decides the same once more."""

import json
import subprocess
import sys

import pytest

from bench.rig import ROOT
from groundstation.recording import schema
from groundstation.review.flight import Flight

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]


def groundstation(*arguments) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", *map(str, arguments)],
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )


def test_a_real_flight_is_decided_the_same_on_its_recorded_inputs(tmp_path):
    flown = groundstation("--sim", "--headless", "--mission", "hover", "--logs", tmp_path)
    assert flown.returncode == 0, flown.stdout + flown.stderr
    (path,) = tmp_path.glob("*.rrd")
    checked = groundstation("replay", path, "--check", "--json")
    told = json.loads(checked.stdout)
    assert (checked.returncode, told["identical"], told["differences"]) == (0, True, []), checked.stderr
    flight = Flight(path)
    assert told["ticks"] == len(flight.series(schema.HANDLE_FORCE).t) > 10_000
    assert told["coupled"] >= 1
    assert told["ending"] == ""
    changed = groundstation("replay", path, "--check", "--set", "control.k1=[1.3,1.2,1.2,1.0]")
    assert changed.returncode == 1
    assert changed.stdout.startswith("different at tick ")
