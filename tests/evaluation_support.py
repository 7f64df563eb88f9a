"""A small mission, and the tasks, outcomes and processes that the tests of the evaluation need."""

import subprocess
import sys

import msgspec

from groundstation.config import Settings
from groundstation.evaluation.case import Case, Outcome, Result, Task
from groundstation.training.mission import Criteria, Mission, Target
from sim.scenario import Cylinder

STEP = Mission(
    schema=1,
    name="step",
    title="A step aside",
    takeoff_altitude_m=1.0,
    target=Target((0.8, 0.0, 1.0), radius=0.3, hold_s=0.5),
    criteria=Criteria(time_limit_s=25.0, final_error_m=0.3),
    obstacle=(Cylinder("post", (3.0, 0.0, 1.0), 0.2, 2.0),),
)
STEP_TOML = """\
schema = 1
name = "step"
title = "A step aside"
takeoff_altitude_m = 1.0
target = { position = [0.8, 0.0, 1.0], radius = 0.3, hold_s = 0.5 }
criteria = { time_limit_s = 25.0, final_error_m = 0.3 }
[[obstacle]]
shape = "cylinder"
name = "post"
center = [3.0, 0.0, 1.0]
radius = 0.2
height = 2.0
"""
CASE = Case(
    controller="assisted",
    guard="barrier",
    mission="step",
    delay=0.0,
    jitter=0.0,
    loss=0.0,
    wind="mission",
    operator="average",
    seed=0,
    rate=250.0,
    airframe="matrice_100",
    model="dynamic",
)


def task(mission=STEP, settings=None, source="", **case):
    return Task(msgspec.structs.replace(CASE, **case), mission, settings or Settings(), source)


def result(outcome=None, **case):
    one = task(**case)
    return Result(
        one.id, one.case, outcome or Outcome(completed=True, time=10.0, rms_error=0.1, clearance=1.0)
    )


def evaluate(folder, *options):
    """Start `groundstation evaluate` on the small mission."""
    (folder / "step.toml").write_text(STEP_TOML)
    command = [
        sys.executable,
        "-m",
        "groundstation.cli",
        "evaluate",
        "--mission",
        "step.toml",
        "--rate",
        "250",
    ]
    return subprocess.Popen(
        [*command, *options], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
