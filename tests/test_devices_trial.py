"""Trying a device out: signs are read from motion, forces asked for; and the loop that keeps it going."""

from itertools import pairwise
from math import hypot

import pytest

from drivers.device import ZERO3, DeviceInfo, HandleState
from drivers.scripted import ScriptedHand
from drivers.stick import StickSender
from groundstation.devices.loop import GENTLE_N, DeviceLoop
from groundstation.devices.trial import Outcome, Trial, steps_for

FORCE = DeviceInfo("test", "", 4, 0.1, 10.0, 1000.0, 1000.0, "force")


def at(x=0.0, y=0.0, z=0.0, yaw=0.0):
    return HandleState((x, y, z), ZERO3, yaw, 0, homed=True, device_time=0.0)


def moved(trial, **where):
    trial.look(at(**where))
    trial.look(at())


def test_a_device_whose_axes_and_forces_are_right_passes():
    trial = Trial(FORCE)
    for where in ({"x": 0.06}, {"y": 0.06}, {"z": 0.06}, {"yaw": 0.4}):
        moved(trial, **where)
    while trial.step:
        trial.answer(yes=True)
    assert trial.passed
    assert len(trial.results) == 7


def test_a_wrong_sign_and_a_swapped_axis_are_told():
    trial = Trial(FORCE)
    moved(trial, x=-0.06)
    moved(trial, z=0.06)
    assert [outcome for _, outcome, _ in trial.results] == [Outcome.FAILED, Outcome.FAILED]
    assert [words for *_, words in trial.results] == ["reads as -x", "reads as +z"]
    while trial.step:
        trial.skip()
    assert not trial.passed


def test_an_oblique_or_small_motion_decides_nothing():
    trial = Trial(FORCE)
    moved(trial, x=0.06, y=0.05)
    moved(trial, x=0.03)
    trial.look(at(x=0.06))
    assert trial.results == []
    trial.answer(yes=True)
    assert trial.results == []


def test_forces_point_where_the_question_says_and_are_gentle():
    trial = Trial(FORCE)
    for _ in range(4):
        trial.skip()
    for axis in range(3):
        pushes = [trial.push(0.01 * tick) for tick in range(300)]
        assert max(push[axis] for push in pushes) == pytest.approx(1.5, abs=0.01)
        assert min(push[axis] for push in pushes) == 0.0
        assert all(push[other] == 0.0 for push in pushes for other in range(3) if other != axis)
        trial.answer(yes=False)
    assert trial.push(0.3) == ZERO3
    assert not trial.passed


def test_only_what_the_device_has_is_tried():
    flat = DeviceInfo("flat", "", 2, 0.1, 1.0, 100.0, 1000.0, "rumble")
    assert [step.name for step in steps_for(flat)] == ["forward", "left", "rumble"]
    silent = DeviceInfo("mouse", "", 3, 0.1, 0.0, 0.0, 100.0, "nothing")
    assert [step.name for step in steps_for(silent)] == ["forward", "left", "up"]


def test_the_loop_presses_gently_and_lets_go_at_the_end(tmp_path):
    now = 10.0
    socket = str(tmp_path / "hand.sock")
    device = ScriptedHand(socket, lambda: now)
    loop = DeviceLoop(device, lambda: now, lambda work: work())
    sender = StickSender(socket)
    loop.push = lambda _t: (50.0, 0.0, 0.0)
    forces = []
    loop.turn(now)
    for _ in range(600):
        now += 0.001
        sender.send(ZERO3, 0.0, 0, now)
        loop.turn(now)
        forces.append(loop.force)
    assert loop.state is not None
    assert hypot(*forces[-1]) == pytest.approx(GENTLE_N)
    assert all(abs(b[0] - a[0]) <= 10.0 * 0.001 + 1e-9 for a, b in pairwise(forces))
    assert loop.state.position[0] > 0.005
    loop.push = lambda _t: (float("nan"), 0.0, 0.0)
    for _ in range(300):
        now += 0.001
        sender.send(ZERO3, 0.0, 0, now)
        loop.turn(now)
    assert loop.force == ZERO3
    loop.keeper.close()
    sender.close()
