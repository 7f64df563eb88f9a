"""The Inverse3: messages, and the driver against an emulated service over a real WebSocket."""

from __future__ import annotations

import contextlib
import json
import math
import select
import socket
import subprocess
import sys
import threading
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3, DeviceError
from drivers.emulators.hand import EmulatedHand, Intention, circle
from drivers.emulators.inverse3 import DEVICE_ID, Inverse3Emulator
from drivers.emulators.registry import serve
from drivers.inverse3 import driver, messages, service
from drivers.inverse3.driver import WORKSPACE, Inverse3
from drivers.inverse3.messages import Dialect, Speaker
from drivers.registry import make_device
from drivers.stick import StickSender

TICK = 1e-3


class Clock:
    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


class Rig:
    """A driver and a service. Opening waits for the service, so that turns in a thread then; later by ticks."""

    def __init__(self, motion=lambda t: Intention(), speaks=Dialect.VECTOR, **settings) -> None:
        self.clock = Clock()
        hand = EmulatedHand(WORKSPACE, self.clock, motion=motion)
        self.emulator = Inverse3Emulator(hand, self.clock, speaks)
        self.device = Inverse3(self.emulator.uri.removeprefix("inverse3:"), self.clock, **settings)

    def served(self, act):
        done = threading.Event()
        thread = threading.Thread(target=serve, args=(self.emulator, lambda: not done.is_set()))
        thread.start()
        try:
            return act()
        finally:
            done.set()
            thread.join()

    def open(self):
        self.served(self.device.open)
        self.emulator.turn()

    def turn(self):
        """Let the service have what was sent: the kernel delivers on loopback as it likes."""
        patience = 0.2 if self.device._under_way and not self.emulator.silent else 0.0
        select.select(self.emulator.descriptors(), [], [], patience)
        self.emulator.turn()

    def hear(self):
        connection = self.device._socket
        if connection is not None and not self.emulator.silent:
            connection.wait(0.2)

    def tick(self, force=ZERO3):
        self.clock.now += TICK
        self.turn()
        self.hear()
        state = self.device.read()
        self.device.write_force(force)
        return state

    def run(self, seconds, force=ZERO3):
        return [self.tick(force) for _ in range(round(seconds / TICK))]

    def close(self):
        self.device.close()
        self.emulator.close()


@pytest.fixture(params=list(Dialect))
def rig(request):
    rig = Rig(speaks=request.param)
    rig.open()
    yield rig
    rig.close()


# Messages


def test_a_force_is_told_as_the_documentation_says():
    text = Speaker("049D", Dialect.VECTOR).force((1.0, 2.0, -0.5))
    assert json.loads(text) == {
        "inverse3": [
            {
                "device_id": "049D",
                "commands": {"set_cursor_force": {"vector": {"x": -2.0, "y": 1.0, "z": -0.5}}},
            }
        ]
    }
    assert '"values"' in Speaker("049D", Dialect.VALUES).force(ZERO3)


@given(st.text(), st.sampled_from(Dialect), st.tuples(*(st.floats(-10, 10),) * 3))
def test_a_force_is_json_for_every_device_and_force(device_id, dialect, force):
    told = json.loads(Speaker(device_id, dialect).force(force))["inverse3"][0]
    assert told["device_id"] == device_id
    xyz = told["commands"]["set_cursor_force"][dialect.value]
    assert (xyz["y"], -xyz["x"], xyz["z"]) == pytest.approx(force, abs=6e-5)


DOCUMENTED = """{"session_id": 7, "inverse3": [{"device_id": "049D",
 "config": {"type": "inverse3", "port": "COM12", "handedness": "right", "preset": "defaults",
            "device_info": {"major_version": 7, "id": "049D", "device_type": 4, "uuid": "…"},
            "basis": {"permutation": "XYZ"}, "filters": {"force_gate": {"gain": 0.3}}},
 "state": {"cursor_position": {"x": 0.0, "y": -0.12, "z": 0.15},
           "cursor_velocity": {"x": 0.1, "y": 0.2, "z": 0.3},
           "angular_position": {"a0": 0.0, "a1": 0.0, "a2": 0.0},
           "current_cursor_force": {"x": 0, "y": 0, "z": 0}, "control_mode": "idle"},
 "status": {"calibrated": true}}],
 "wireless_verse_grip": [{"device_id": "1", "state": {"buttons": {"a": false, "b": true, "c": true},
                          "orientation": {"w": 1, "x": 0, "y": 0, "z": 0}}}]}"""


def test_the_documented_snapshot_is_understood():
    message = messages.decode(DOCUMENTED)
    device = messages.find(message, "")
    assert device.config.preset == "defaults"
    assert messages.sample(device.state) == ((-0.12, -0.0, 0.15), (0.2, -0.1, 0.3))
    assert messages.buttons(message) == 6
    with pytest.raises(DeviceError, match="0001: no Inverse3 with this id.*049D"):
        messages.find(message, "0001")


@given(st.one_of(st.text(), st.binary()))
def test_no_text_breaks_the_decoder(text):
    messages.decode(text)


@pytest.mark.parametrize(
    "bad", ["NaN", "Infinity", "-Infinity", "1e400", "null", '"0.1"', "true", "[]", "120.0"]
)
@pytest.mark.parametrize("field", ["cursor_position", "cursor_velocity"])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_number_that_is_none_gives_no_sample(bad, field, axis):
    before, after = DOCUMENTED.split(f'"{field}": {{')
    inside, rest = after.split("}", 1)
    parts = [
        f'"{axis}": {bad}' if part.strip().startswith(f'"{axis}"') else part for part in inside.split(",")
    ]
    message = messages.decode(f'{before}"{field}": {{{",".join(parts)}}}{rest}')
    assert message is None or messages.sample(message.inverse3[0].state) is None


@pytest.mark.parametrize(
    ("answer", "dialect"),
    [
        (b'{"project_version": "3.5.1.0"}', Dialect.VECTOR),
        (b'{"project_version": "3.1.0.0"}', Dialect.VECTOR),
        (b'{"project_version": "3.0.7.0", "git_tag": "3.0.7"}', Dialect.VALUES),
        (b'{"project_version": "10.0"}', Dialect.VECTOR),
        (b'{"project_version": "new"}', None),
        (b"{}", None),
        (b"<html>", None),
        (b"\xff", None),
    ],
)
def test_the_version_tells_the_dialect(answer, dialect):
    assert messages.dialect_of(answer) is dialect


# Addresses and settings


def test_addresses():
    local = (("localhost", 10001), ("localhost", 10000))
    assert service.parse("") == (local, "")
    assert service.parse("049D") == (local, "049D")
    assert service.parse("10.0.0.2:10001") == ((("10.0.0.2", 10001),), "")
    assert service.parse("[::1]:10000/049D") == ((("::1", 10000),), "049D")
    for bad in ("host:", "host:x", "host:0", "host:70000"):
        with pytest.raises(DeviceError, match="no port"):
            service.parse(bad)


@pytest.mark.parametrize("bad", ["", "vectors", 3, None])
def test_a_dialect_that_is_none_is_told(bad):
    with pytest.raises(DeviceError, match="devices.inverse3.dialect"):
        Inverse3("", dialect=bad)


@pytest.mark.parametrize("bad", [[0.0, 0.0], [0, 0, 9], [0, 0, math.nan], ["a", 0, 0], 3.0, None])
def test_a_centre_that_is_none_is_told(bad):
    with pytest.raises(DeviceError, match="devices.inverse3.centre"):
        Inverse3("", centre=bad)


# The driver


def test_it_takes_the_dialect_of_the_service_and_reads_where_the_hand_goes(rig):
    rig.emulator._hand._motion = lambda t: Intention((0.05, -0.03, 0.02), buttons=5)
    state = rig.run(1.0)[-1]
    assert state.position == pytest.approx((0.05, -0.03, 0.02), abs=1e-4)
    assert state.velocity == pytest.approx(ZERO3, abs=1e-3)
    assert state.buttons == 5
    assert state.homed
    assert rig.clock.now - state.device_time <= 1.001 * TICK
    assert rig.device.info.serial == DEVICE_ID
    assert rig.device.refused == 0


def test_a_force_reaches_the_hand_as_it_is_meant(rig):
    state = rig.run(1.2, force=(2.7, -1.35, 0.675))[-1]
    assert rig.emulator.force == pytest.approx((2.7, -1.35, 0.675), abs=1e-4)
    assert state.position == pytest.approx((0.02, -0.01, 0.005), abs=1e-4)
    rig.run(0.05, force=(30.0, 0.0, 40.0))
    assert rig.emulator.force == pytest.approx((6.0, 0.0, 8.0), abs=1e-4)


def test_the_dialect_of_the_users_settings_wins():
    """Here over what the service understands, so nothing is rendered: it was the setting that was followed."""
    rig = Rig(speaks=Dialect.VALUES, dialect="vector")
    rig.open()
    rig.run(0.02, force=(2.0, 0.0, 0.0))
    assert rig.emulator.force == ZERO3
    rig.close()


def test_it_knows_its_speed():
    rig = Rig(motion=circle(0.05, 2.0))
    rig.open()
    states = rig.run(3.0)[2000:]
    for before, state, after in zip(states, states[5:], states[10:], strict=False):
        slope = [(b - a) / (10 * TICK) for a, b in zip(before.position, after.position, strict=True)]
        assert math.dist(state.velocity, slope) <= 0.005
    rig.close()


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_force_that_is_not_a_number_becomes_none(rig, bad):
    rig.run(0.05, force=(2.0, 0.0, 0.0))
    rig.clock.now += TICK
    rig.turn()
    rig.device.read()
    with pytest.raises(DeviceError, match="not a number"):
        rig.device.write_force((0.0, bad, 0.0))
    rig.turn()
    assert rig.emulator.force == ZERO3


def test_not_calibrated_is_not_homed_and_presses_nothing(rig):
    rig.run(0.05, force=(2.0, 0.0, 0.0))
    rig.emulator.calibrated = False
    states = rig.run(0.02, force=(2.0, 0.0, 0.0))
    assert not states[-1].homed
    assert rig.emulator.force == ZERO3
    rig.emulator.calibrated = True
    assert rig.run(0.02, force=(2.0, 0.0, 0.0))[-1].homed
    assert rig.emulator.force == (2.0, 0.0, 0.0)


def test_a_service_that_falls_silent_is_an_error_within_50_ms(rig):
    rig.run(0.1)
    rig.emulator.silent = True
    rig.run(0.048)
    with pytest.raises(DeviceError, match="silent"):
        rig.run(0.01)


def test_a_device_that_is_pulled_out_is_an_error_within_50_ms(rig):
    rig.run(0.1)
    rig.emulator.plugged = False
    with pytest.raises(DeviceError, match="silent"):
        rig.run(0.06)
    rig.emulator.plugged = True
    rig.clock.now += TICK
    rig.device.write_force(ZERO3)
    rig.turn()
    rig.hear()
    assert rig.device.read().homed


def test_a_service_that_ends_is_an_error_at_once(rig):
    rig.run(0.05)
    rig.emulator.close()
    rig.hear()
    with pytest.raises(DeviceError, match="gone"):
        rig.run(0.005)


@pytest.mark.parametrize(
    "bad", ["", "{", '{"inverse3":[{}]}', '{"inverse3":7}', DOCUMENTED.replace("-0.12", "-120.0")]
)
def test_messages_that_are_none_are_passed_over_and_counted_and_end_in_an_error(rig, bad):
    before = rig.run(0.02)[-1]
    rig.emulator.spoil = lambda text: bad
    state = rig.run(0.01)[-1]
    assert state.position == pytest.approx(before.position)
    assert state.device_time < rig.clock.now - 0.005
    assert rig.device.refused >= 9
    with pytest.raises(DeviceError, match="silent"):
        rig.run(0.06)


def test_no_more_than_three_messages_are_under_way(rig):
    rig.run(0.02)
    sent = []
    rig.device._socket.send = lambda text, send=rig.device._socket.send: sent.append(text) or send(text)
    for _ in range(30):
        rig.device.write_force((1.0, 0.0, 0.0))
    assert len(sent) <= 3


def test_a_device_that_nobody_writes_to_is_still_asked_and_presses_nothing(rig):
    rig.run(0.05, force=(2.0, 0.0, 0.0))
    for _ in range(20):
        rig.clock.now += TICK
        rig.turn()
        rig.device.read()
    assert rig.emulator.force == ZERO3
    assert rig.clock.now - rig.device.read().device_time <= 3 * TICK


def test_closing_ends_the_force_and_may_be_done_twice(rig):
    rig.run(0.05, force=(2.0, 0.0, 0.0))
    rig.device.close()
    rig.turn()
    assert rig.emulator.force == ZERO3
    rig.device.close()
    with pytest.raises(DeviceError, match="not open"):
        rig.device.read()


def test_it_opens_again(rig):
    rig.run(0.02)
    rig.open()
    assert rig.run(0.02)[-1].homed


def test_no_service_is_told():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    with pytest.raises(DeviceError, match="no Inverse Service listens there"):
        Inverse3(f"127.0.0.1:{port}").open()


def test_who_listens_but_says_nothing_is_told():
    with socket.create_server(("127.0.0.1", 0)) as mute, pytest.raises(DeviceError, match="does not answer"):
        Inverse3(f"127.0.0.1:{mute.getsockname()[1]}").open()


def test_no_device_with_this_id_is_told():
    rig = Rig()
    rig.device = Inverse3(rig.emulator.uri.removeprefix("inverse3:") + "/0001", rig.clock)
    with pytest.raises(DeviceError, match="0001: no Inverse3 with this id"):
        rig.open()
    rig.emulator.plugged = False
    with pytest.raises(DeviceError, match="has no Inverse3"):
        rig.open()
    rig.close()


def test_it_is_discovered(monkeypatch):
    rig = Rig()
    port = int(rig.emulator.uri.rpartition(":")[2])
    monkeypatch.setattr(service, "PORTS", (port,))
    (found,) = rig.served(driver.discover)
    assert (found.uri, found.serial, found.renders, found.usable) == ("inverse3:049D", "049D", "force", True)
    rig.close()
    assert driver.discover() == []


def test_without_its_library_it_says_what_to_install():
    program = """
import sys
sys.modules["wsproto"] = None
from drivers.inverse3.driver import Inverse3, discover
from drivers.device import DeviceError
(found,) = discover()
assert not found.usable and "groundstation[inverse3]" in found.remedy, found
try:
    Inverse3("").open()
except DeviceError as error:
    assert "groundstation[inverse3]" in str(error)
else:
    raise AssertionError
"""
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_end_to_end_in_real_time_with_the_emulator_in_its_own_process(tmp_path):
    sender = StickSender(str(tmp_path / "hand"))
    device = make_device(f"emulated:inverse3@{tmp_path}/hand")
    device.open()
    until, position = time.monotonic() + 30.0, ZERO3
    while math.dist(position, (0.03, -0.02, 0.0)) > 1e-3:
        assert time.monotonic() < until
        sender.send((0.03, -0.02, 0.0), 0.0, 0, time.monotonic())
        with contextlib.suppress(DeviceError):  # the machine may be busy for longer than a silence
            position = device.read().position
            device.write_force(ZERO3)
        time.sleep(TICK)
    device.close()
    sender.close()
