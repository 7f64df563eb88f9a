"""Programmed and recorded hands, on the scripted handle and on emulated ones."""

from __future__ import annotations

import math

import pytest

from drivers.device import ZERO3, DeviceError
from drivers.emulators.hand import EmulatedHand
from drivers.motion import Intention, circle, motion_named, recorded, rest
from drivers.registry import make_device
from drivers.scripted import ScriptedHand
from drivers.stick import StickSender


class Clock:
    def __init__(self) -> None:
        self.now = 10.0

    def __call__(self) -> float:
        return self.now


def write(folder, text):
    file = folder / "hand.csv"
    file.write_text(text)
    return str(file)


def test_a_circle_begins_in_the_centre_and_closes():
    motion = circle(0.02, 4.0)
    assert motion(0.0).position == ZERO3
    assert math.hypot(*motion(2.0).position) == pytest.approx(0.01)
    assert motion(5.0).position == pytest.approx(motion(9.0).position)
    assert math.hypot(*motion(6.3).position) == pytest.approx(0.02)


def test_a_recording_is_played_from_its_first_sample(tmp_path):
    motion = recorded(
        write(tmp_path, "t,x,y,z,yaw,buttons\n100,0,0,0,0,0\n101,0.1,0,-0.2,0.5,2\n103,0.1,0.1,0,0,0\n")
    )
    assert motion(0.0) == Intention()
    assert motion(0.5) == Intention((0.05, 0.0, -0.1), 0.25, 0)
    assert motion(1.0) == Intention((0.1, 0.0, -0.2), 0.5, 2)
    assert motion(2.0).position == pytest.approx((0.1, 0.05, -0.1))
    assert motion(99.0) == Intention((0.1, 0.1, 0.0), 0.0, 0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no column t, x, y, z"),
        ("t,x,y\n1,2,3\n", "no column z"),
        ("t,x,y,z\n", "no samples"),
        ("t,x,y,z\n0,0,0\n", "line 2: is not all numbers"),
        ("t,x,y,z\n0,0,0,up\n", "line 2: is not all numbers"),
        ("t,x,y,z\n0,0,0,0\n0,0,0,0\n", "line 3: time must rise"),
        ("t,x,y,z\nnan,0,0,0\n", "line 2: time must rise"),
        ("t,x,y,z\n0,0,nan,0\n", "line 2: time must rise"),
        ("t,x,y,z\n0,0,inf,0\n", "line 2: time must rise"),
        ("t,x,y,z\n0,0,1.5,0\n", "positions be within 1 m"),
        ("t,x,y,z,yaw\n0,0,0,0,4\n", "yaw within π"),
        ("t,x,y,z,buttons\n0,0,0,0,-1\n", "line 2"),
    ],
)
def test_what_is_not_a_recording_is_told_with_its_line(tmp_path, text, words):
    with pytest.raises(DeviceError, match=words):
        recorded(write(tmp_path, text))


def test_a_recording_that_cannot_be_read_is_told(tmp_path):
    with pytest.raises(DeviceError, match="cannot be read"):
        recorded(str(tmp_path / "none.csv"))
    (tmp_path / "b.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DeviceError, match="cannot be read"):
        recorded(str(tmp_path / "b.csv"))


def test_names():
    assert motion_named("rest") is rest
    assert motion_named("circle") is not None
    assert motion_named("/run/hand.sock") is None


def test_the_scripted_hand_does_what_was_recorded(tmp_path):
    clock = Clock()
    device = ScriptedHand(write(tmp_path, "t,x,y,z,buttons\n0,0,0,0,0\n1,0.04,0,0,1\n"), clock)
    with pytest.raises(DeviceError, match="not open"):
        device.read()
    device.open()
    states = []
    for _ in range(3000):
        clock.now += 1e-3
        states.append(device.read())
        device.write_force((0.0, -1.35, 0.0) if len(states) > 1500 else ZERO3)
    assert states[1400].position == pytest.approx((0.04, 0.0, 0.0), abs=1e-3)
    assert states[-1].position == pytest.approx((0.04, -0.01, 0.0), abs=1e-4)
    assert (states[0].buttons, states[-1].buttons) == (0, 1)
    device.close()
    device.close()
    with pytest.raises(DeviceError, match="not open"):
        device.read()


def test_the_scripted_arm_is_as_heavy_and_stiff_as_set():
    clock = Clock()
    for stiffness, moved in ((135.0, 0.01), (270.0, 0.005)):
        device = ScriptedHand("rest", clock, mass=0.3, stiffness=stiffness)
        device.open()
        device.read()
        device.write_force((1.35, 0.0, 0.0))
        clock.now += 5.0
        assert device.read().position == pytest.approx((moved, 0.0, 0.0), abs=1e-6)
        device.close()


@pytest.mark.parametrize("bad", [0, -1.0, math.nan, math.inf, "heavy", True])
def test_an_impossible_arm_is_told(bad):
    with pytest.raises(DeviceError, match=r"devices\.scripted\.mass: .* not a positive number"):
        make_device("scripted:rest", {"mass": bad})


def test_an_emulated_hand_follows_its_socket_and_lets_go_in_silence(tmp_path):
    clock, path = Clock(), str(tmp_path / "hand")
    hand, sender = EmulatedHand(0.04, clock, path), StickSender(path)
    try:
        for _ in range(60):
            clock.now += 0.02
            assert sender.send((0.1, 0.0, 0.0), 0.0, 3, clock.now)
            state = hand.step(clock.now, ZERO3)
        assert state.position == pytest.approx((0.04, 0.0, 0.0), abs=1e-4)
        assert state.buttons == 3
        for _ in range(100):
            clock.now += 0.02
            state = hand.step(clock.now, ZERO3)
        assert state.position == pytest.approx(ZERO3, abs=1e-5)
        assert state.buttons == 0
    finally:
        sender.close()
        hand.close()


def test_an_emulated_hand_goes_round_and_yields():
    clock = Clock()
    hand = EmulatedHand(0.05, clock, "circle")
    places = []
    for _ in range(8000):
        clock.now += 1e-3
        places.append(hand.step(clock.now, (0.0, 0.0, 1.35)).position)
    assert max(x for x, _, _ in places[4000:]) == pytest.approx(0.02, abs=1e-3)
    assert places[-1][2] == pytest.approx(0.01, abs=1e-5)
