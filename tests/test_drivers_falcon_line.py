"""Driver and emulator over a pseudo-terminal: the bytes of the real device through pyserial."""

from __future__ import annotations

import contextlib
import math
import select
import threading
from itertools import pairwise
from random import Random

import pytest

from drivers.device import ZERO3, DeviceError
from drivers.emulators.falcon import FalconEmulator, Stage
from drivers.emulators.faults import Faults
from drivers.emulators.hand import EmulatedHand, Intention, circle, rest
from drivers.falcon import driver
from drivers.falcon.driver import Falcon
from drivers.falcon.packet import BLUE, GREEN, NO_FORCE, RED
from drivers.registry import make_device
from drivers.serial_ports import UsbId

TICK = 1e-3


class Clock:
    def __init__(self) -> None:
        self.now = 200.0

    def __call__(self) -> float:
        return self.now


class Rig:
    """Both ends of the line and their common clock."""

    def __init__(self, motion=rest, *, loaded=True, firmware=""):
        self.clock = Clock()
        self.hand = EmulatedHand(driver.WORKSPACE, self.clock, motion=motion)
        self.emulator = FalconEmulator(self.hand, self.clock, loaded=loaded)
        path = self.emulator.uri.partition(":")[2]
        self.device = Falcon(path, self.clock, firmware=str(firmware))
        self.answered = 0
        write = self.emulator._pty.write

        def counted(data):
            self.answered += len(data)
            write(data)

        self.emulator._pty.write = counted

    def open(self):
        """Open blocks, as it talks to the device; the device answers meanwhile."""
        errors = []

        def work():
            try:
                self.device.open()
            except DeviceError as error:
                errors.append(error)

        thread = threading.Thread(target=work)
        thread.start()
        while thread.is_alive():
            select.select(self.emulator.descriptors(), [], [], 0.001)
            self.emulator.turn()
        thread.join()
        if errors:
            raise errors[0]

    def tick(self, force=None):
        """One tick: a force or none, time, the device's answer, the handle."""
        if force is not None:
            self.device.write_force(force)
        self.clock.now += TICK
        self.turn()
        return self.device.read()

    def turn(self):
        """The device's turn. A pseudo-terminal's bytes are handed on by a worker of the kernel's: await them."""
        before = self.answered
        self.emulator.turn()
        if self.answered > before:
            select.select([self.device._port.fileno()], [], [], 1.0)

    def until_error(self, ticks=200):
        """Tick until the driver complains; return its words."""
        for _ in range(ticks):
            try:
                state = self.tick(ZERO3)
            except DeviceError as error:
                return str(error)
            assert self.clock.now - state.device_time <= 0.05
        raise AssertionError("no error")

    def run(self, seconds, force=ZERO3):
        states = []
        for _ in range(round(seconds / TICK)):
            states.append(self.tick(force(states[-1]) if callable(force) and states else ZERO3))
            if not callable(force):
                self.device.write_force(force)
        return states

    def homed(self):
        self.open()
        for _ in range(2000):
            if self.tick(ZERO3).homed:
                return self
        raise AssertionError("never homed")

    def close(self):
        self.device.close()
        self.emulator.close()


@pytest.fixture
def rigs():
    """Make rigs that are closed at the end."""
    made = []

    def make(*args, **options):
        made.append(Rig(*args, **options))
        return made[-1]

    yield make
    for rig in made:
        rig.close()


def test_it_homes_and_is_in_the_centre_and_its_lights_tell(rigs):
    rig = rigs()
    rig.open()
    assert not rig.tick(ZERO3).homed
    states = [rig.tick((1.0, 0.0, 0.0)) for _ in range(500)]
    assert not any(state.homed for state in states)
    assert {state.position for state in states} == {ZERO3}
    assert rig.emulator.request.lights == RED
    assert rig.emulator.request.forces == NO_FORCE
    assert rig.emulator.request.homing
    states = [rig.tick(ZERO3) for _ in range(200)]
    assert states[-1].homed
    assert math.hypot(*states[-1].position) < 1e-4
    assert rig.emulator.request.lights == BLUE
    rig.tick((1.0, 0.0, 0.0))
    assert rig.emulator.request.lights == GREEN


def test_a_known_motion_is_read_with_its_speed(rigs):
    rig = rigs(circle(0.02, 2.0)).homed()
    rig.run(2.0)
    truth, errors, speeds = None, [], []
    for _ in range(2000):
        before = truth
        rig.device.write_force(ZERO3)
        rig.clock.now += TICK
        rig.turn()
        truth = rig.hand.step(rig.clock.now, ZERO3)
        state = rig.device.read()
        errors.append(math.dist(state.position, truth.position))
        speeds.append(math.dist(state.velocity, truth.velocity))
        assert rig.clock.now - TICK * 1.5 <= state.device_time <= rig.clock.now
        assert before is None or truth != before
    # An encoder's count is 0.05 mm, and the sample is of the request, not of now.
    assert max(errors) < 1e-4
    # The hand goes at 63 mm/s: differences of neighbouring samples would be off by 50 mm/s.
    assert sorted(speeds)[len(speeds) // 2] < 4e-3
    assert max(speeds) < 0.03


def test_at_rest_the_speed_is_zero(rigs):
    rig = rigs().homed()
    assert all(state.velocity == ZERO3 for state in rig.run(0.3)[100:])


@pytest.mark.parametrize("axis", range(3))
def test_the_force_is_felt_with_its_size_and_direction(rigs, axis):
    """2 N on the emulated arm, k = 135 N/m, move it by 14.8 mm the way they push."""
    rig = rigs().homed()
    force = tuple(2.0 if i == axis else 0.0 for i in range(3))
    state = rig.run(1.5, force)[-1]
    assert rig.emulator.force == pytest.approx(force, abs=0.02)
    expected = tuple(component / 135.0 for component in force)
    assert state.position == pytest.approx(expected, abs=3e-4)


def test_more_force_than_it_has_keeps_its_direction(rigs):
    rig = rigs().homed()
    rig.tick((300.0, 0.0, 400.0))
    rig.tick((300.0, 0.0, 400.0))
    x, y, z = rig.emulator.force
    assert math.hypot(x, y, z) > 4.0
    assert x / z == pytest.approx(0.75, abs=0.005)
    assert abs(y) < 0.01
    assert max(map(abs, rig.emulator.request.forces)) == 4095


def test_a_spring_on_the_driver_side_holds_the_hand_that_pushes(rigs):
    """The loop through both ends of the line is a spring of the asked stiffness."""
    rig = rigs(lambda t: Intention((0.02, 0.0, 0.0))).homed()
    state = rig.run(2.0, lambda s: tuple(-135.0 * x for x in s.position))[-1]
    assert state.position[0] == pytest.approx(0.01, abs=5e-4)


def test_buttons_come_through_after_three_agreeing_replies(rigs):
    pressed = {"buttons": 0}
    rig = rigs(lambda t: Intention(buttons=pressed["buttons"])).homed()
    for buttons in (1, 2, 4, 8, 15, 0):
        pressed["buttons"] = buttons
        came = [rig.tick(ZERO3).buttons for _ in range(5)]
        assert came[-1] == buttons
        assert came[0] != buttons


def test_a_force_lasts_only_as_long_as_it_is_written(rigs):
    rig = rigs().homed()
    rig.tick((3.0, 0.0, 0.0))
    assert rig.emulator.request.forces != NO_FORCE
    rig.tick()
    rig.tick()
    assert rig.emulator.request.forces == NO_FORCE
    rig.tick((3.0, 0.0, 0.0))
    rig.device.close()
    rig.emulator.turn()
    assert rig.emulator.request.forces == NO_FORCE
    assert rig.emulator.request.lights == RED


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_force_that_is_not_a_number_becomes_none(rigs, bad):
    rig = rigs().homed()
    rig.tick((3.0, 0.0, 0.0))
    with pytest.raises(DeviceError, match="not a number"):
        rig.device.write_force((0.0, bad, 0.0))
    rig.emulator.turn()
    assert rig.emulator.request.forces == NO_FORCE


def test_silence_is_an_error_within_50_ms_and_no_old_state_comes(rigs):
    rig = rigs(circle(0.02, 2.0)).homed()
    rig.run(0.2)
    began = rig.clock.now
    rig.emulator.silent = True
    assert "is silent; check" in rig.until_error()
    assert rig.clock.now - began <= 0.053
    assert "is silent; check" in rig.until_error(1)
    rig.emulator.silent = False
    for _ in range(10):
        with contextlib.suppress(DeviceError):
            rig.tick(ZERO3)
    assert rig.tick(ZERO3).homed


def test_replies_that_cannot_be_believed_are_as_good_as_silence(rigs):
    """A device that answers, but never twice alike, gives no state."""
    rig = rigs().homed()
    rig.run(0.1)
    chance = Random(1)
    rig.emulator._absolute = lambda: tuple(chance.randint(-30000, 30000) for _ in range(3))
    assert "silent" in rig.until_error()
    assert rig.device.refused > 30


def test_unplugging_is_an_error_at_once_and_it_can_be_plugged_in_again(rigs):
    rig = rigs().homed()
    rig.run(0.1)
    began = rig.clock.now
    rig.emulator.unplug()
    assert "Falcon is gone" in rig.until_error()
    assert rig.clock.now - began <= 0.01
    rig.device.close()
    with pytest.raises(DeviceError, match="no such serial port"):
        rig.device.open()
    rig.emulator.plug()
    rig.homed()
    assert math.hypot(*rig.tick(ZERO3).position) < 1e-4


def test_a_bad_line_makes_no_false_event_and_no_leap(rigs):
    """1 % of bytes spoilt both ways: what is read stays where the hand is, without false buttons."""
    rig = rigs(circle(0.02, 2.0)).homed()
    rig.run(0.5)
    rig.emulator.faults = Faults(0.01 / 3, 0.01 / 3, 0.01 / 3, Random(4))
    states = rig.run(4.0)
    assert rig.emulator.faults.events > 400
    assert {state.buttons for state in states} == {0}
    assert all(state.homed for state in states)
    # At 63 mm/s a request lost costs at most the 4 ms to the next, a few in a row 20 ms.
    assert max(math.dist(a.position, b.position) for a, b in pairwise(states)) < 2e-3
    assert max(math.hypot(*state.velocity) for state in states) < 0.2


def test_not_opened_and_closed_twice(rigs):
    rig = rigs()
    for act in (rig.device.read, lambda: rig.device.write_force(ZERO3)):
        with pytest.raises(DeviceError, match="not open"):
            act()
    rig.device.close()
    rig.open()
    rig.device.close()
    rig.device.close()
    with pytest.raises(DeviceError, match="not open"):
        rig.device.read()


# Firmware


@pytest.fixture
def firmware(tmp_path):
    """Bytes as good as any: the real ones may not be here. One short chunk at the end, and '<' and XON in it."""
    file = tmp_path / "firmware.bin"
    file.write_bytes(Random(6).randbytes(62 * 9 + 17))
    return file


def test_firmware_is_loaded_by_the_documented_sequence(rigs, firmware):
    rig = rigs(loaded=False, firmware=firmware)
    rig.homed()
    assert rig.emulator.stage is Stage.RUNNING
    assert rig.emulator.firmware == firmware.read_bytes()


def test_a_device_that_runs_is_not_loaded_again(rigs, firmware):
    rig = rigs(firmware=firmware)
    rig.homed()
    assert rig.emulator.firmware == b""


def test_without_a_path_it_says_which_setting_to_make(rigs):
    rig = rigs(loaded=False)
    with pytest.raises(DeviceError, match=r"no path to it is set; set firmware = .*\[devices.falcon\]"):
        rig.open()


def test_a_load_that_goes_wrong_is_tried_again(rigs, firmware, monkeypatch):
    rig = rigs(loaded=False, firmware=firmware)
    write, spoilt = rig.emulator._pty.write, []

    def bad_once(data):
        if len(data) == 62 and not spoilt:
            spoilt.append(data)
            data = bytes([data[0] ^ 1]) + data[1:]
        write(data)

    monkeypatch.setattr(rig.emulator._pty, "write", bad_once)
    rig.homed()
    assert spoilt
    assert rig.emulator.firmware == firmware.read_bytes()


@pytest.mark.parametrize(
    ("answer", "words"),
    [(5, "does not answer; check its power"), (1, "is not ready"), (62, "gave back other firmware")],
)
def test_a_load_that_always_goes_wrong_is_told(rigs, firmware, monkeypatch, answer, words):
    """Answers of this length come with a bit turned: the greeting, the one before the firmware, its echo."""
    rig = rigs(loaded=False, firmware=firmware)
    write = rig.emulator._pty.write
    for name in ("_GREETINGS", "_ECHO_S"):
        monkeypatch.setattr(f"drivers.falcon.firmware.{name}", 0.2 if name == "_ECHO_S" else 3)

    def bad(data):
        write(data[:-1] + bytes([data[-1] ^ 8]) if len(data) == answer else data)

    monkeypatch.setattr(rig.emulator._pty, "write", bad)
    with pytest.raises(DeviceError, match=words):
        rig.open()


def test_firmware_that_does_not_run_is_told(rigs, firmware, monkeypatch):
    rig = rigs(loaded=False, firmware=firmware)
    rig.emulator.silent = True
    with pytest.raises(DeviceError, match="has taken its firmware and does not answer"):
        rig.open()


@pytest.mark.parametrize(("content", "words"), [(b"", "0 bytes long"), (b"x" * (2**20 + 1), "bytes long")])
def test_what_cannot_be_firmware_is_refused(rigs, tmp_path, content, words):
    file = tmp_path / "firmware.bin"
    file.write_bytes(content)
    rig = rigs(loaded=False, firmware=file)
    with pytest.raises(DeviceError, match=words):
        rig.open()


def test_firmware_that_is_not_there_is_told(rigs, tmp_path):
    rig = rigs(loaded=False, firmware=tmp_path / "none.bin")
    with pytest.raises(DeviceError, match="none.bin cannot be read"):
        rig.open()


# Who it is and where


def test_it_is_made_from_its_uri_with_its_setting():
    device = make_device("falcon:/dev/ttyUSB7", {"firmware": "/somewhere/f.bin"})
    assert isinstance(device, Falcon)
    assert device.info.name == "Novint Falcon"
    assert (device.info.axes, device.info.rate, device.info.renders) == (3, 1000.0, "force")
    with pytest.raises(DeviceError, match="/dev/ttyUSB7: there is no such serial port"):
        device.open()
    with pytest.raises(DeviceError, match=r"devices.falcon.firmwear: .* it has: firmware\."):
        make_device("falcon", {"firmwear": "x"})
    with pytest.raises(DeviceError, match="is not a path"):
        make_device("falcon", {"firmware": 3})


def test_none_connected_is_told():
    with pytest.raises(DeviceError, match="No Novint Falcon is connected"):
        Falcon("").open()


class FakeUsb:
    """Linux's list of USB devices, as files."""

    def __init__(self, folder, monkeypatch):
        self.folder = folder
        monkeypatch.setattr("drivers.serial_ports.USB_DEVICES", folder)

    def add(self, name, vendor, product, serial="", tty=""):
        device = self.folder / name
        device.mkdir()
        (device / "idVendor").write_text(f"{vendor:04x}\n")
        (device / "idProduct").write_text(f"{product:04x}\n")
        if serial:
            (device / "serial").write_text(serial + "\n")
        if tty:
            (device / f"{name}:1.0" / tty).mkdir(parents=True)


def test_a_falcon_that_linux_does_not_know_is_found_with_the_command_that_helps(tmp_path, monkeypatch):
    usb = FakeUsb(tmp_path, monkeypatch)
    usb.add("1-1", *driver.USB, serial="FA12")
    usb.add("1-2", *driver.USB, serial="FA13", tty="ttyUSB0")
    usb.add("1-3", 0x0403, 0x6001)
    (tmp_path / "usb1").mkdir()
    monkeypatch.setattr(driver, "usb_ports", lambda *ids: [])
    found = driver.discover()
    assert [device.serial for device in found] == ["FA12"]
    assert not found[0].usable
    assert "ftdi_sio/new_id" in found[0].remedy


def test_a_connected_falcon_is_listed_with_what_is_missing(tmp_path, monkeypatch, firmware):
    from drivers.serial_ports import Port

    FakeUsb(tmp_path, monkeypatch)
    port = tmp_path / "ttyUSB0"
    port.touch()
    monkeypatch.setattr(driver, "usb_ports", lambda *ids: [Port(str(port), "FA12")])
    (found,) = driver.discover()
    assert (found.usable, found.uri, found.port) == (False, "falcon:FA12", str(port))
    assert "no path to it is set" in found.why
    assert "[devices.falcon]" in found.remedy
    (found,) = driver.discover(firmware=str(firmware))
    assert found.usable
    monkeypatch.setattr("drivers.serial_ports.os.access", lambda path, mode: False)
    (found,) = driver.discover(firmware=str(firmware))
    assert "may not read and write" in found.why
    assert 'ATTRS{idVendor}=="0403", ATTRS{idProduct}=="cb48", TAG+="uaccess"' in found.remedy


def test_the_usb_identity_is_written_as_lsusb_does():
    assert str(UsbId(0x0403, 0xCB48)) == "0403:cb48"
