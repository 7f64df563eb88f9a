"""What emulators are made of: the pseudo-terminal, the bad line, the registry, and running one."""

from __future__ import annotations

import os
import threading
import time
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers import serial_ports
from drivers.device import ZERO3, DeviceError
from drivers.emulators.faults import Faults
from drivers.emulators.pty import Pty
from drivers.emulators.registry import BUILT_IN, emulator_names, make_emulator, serve
from drivers.registry import make_device
from drivers.serial_ports import UsbId, find_port, open_port, port_fault, read_now, udev_rule, write_now


@pytest.fixture
def pty():
    pty = Pty()
    yield pty
    pty.close()
    pty.close()


def until(condition):
    """A pseudo-terminal's bytes come by a worker of the kernel's."""
    deadline = time.monotonic() + 5.0
    while not (found := condition()) and time.monotonic() < deadline:
        time.sleep(1e-4)
    return found


def test_bytes_cross_unchanged_both_ways_and_speeds_are_seen(pty):
    port = open_port(pty.path, "thing", 9600)
    every = bytes(range(256))
    assert pty.baudrate() == 9600
    port.baudrate = 142_857
    assert pty.baudrate() == 142_857
    write_now(port, "thing", every)
    assert until(pty.read) == every
    pty.write(every)
    assert until(lambda: read_now(port, "thing")) == every
    assert read_now(port, "thing") == b""
    port.close()


def test_who_has_the_port_open_is_seen(pty):
    assert not pty.opened()
    assert pty.descriptors() == []
    assert pty.read() == b""
    port = open_port(pty.path, "thing", 9600)
    assert pty.opened()
    assert len(pty.descriptors()) == 1
    port.close()
    assert not pty.opened()


def test_a_port_pulled_out_is_told_and_comes_back_on_the_same_path(pty):
    port = open_port(pty.path, "thing", 9600)
    pty.unplug()
    pty.unplug()
    with pytest.raises(DeviceError, match=r"the thing is gone \(Input/output error\); plug it in again"):
        write_now(port, "thing", b"x")
    assert (pty.read(), pty.opened(), pty.descriptors()) == (b"", False, [])
    pty.write(b"lost")
    port.close()
    with pytest.raises(DeviceError, match="cannot be opened|may not read"):
        open_port(pty.path, "thing", 9600)
    pty.plug()
    open_port(pty.path, "thing", 9600).close()


def test_a_device_that_takes_nothing_never_holds_the_writer_up(pty):
    port = open_port(pty.path, "thing", 9600)
    for _ in range(5_000):
        write_now(port, "thing", b"0123456789abcdef")
    port.close()


def test_one_program_has_the_port_at_a_time(pty):
    port = open_port(pty.path, "thing", 9600)
    with pytest.raises(DeviceError, match="cannot be opened"):
        open_port(pty.path, "thing", 9600)
    port.close()


def test_a_port_in_use_is_told_with_its_user(pty):
    opened = threading.Event()
    # Another process, as its own file descriptors are nothing to tell.
    child = os.fork()
    if child == 0:
        fd = os.open(pty.path, os.O_RDWR | os.O_NOCTTY)
        os.write(fd, b"here")
        time.sleep(30)
        os._exit(0)
    try:
        assert until(pty.read) == b"here"
        opened.set()
        fault = port_fault(pty.path)
        assert fault is not None
        assert f"(process {child})" in fault[0]
        assert fault[1] == "end that program"
    finally:
        os.kill(child, 9)
        os.waitpid(child, 0)


def test_a_port_that_may_not_be_opened_is_told_with_the_rule(pty, monkeypatch):
    monkeypatch.setattr(serial_ports.os, "access", lambda path, mode: False)
    fault = port_fault(pty.path, UsbId(0x1, 0xABCD))
    assert fault == ("you may not read and write this port", udev_rule(UsbId(0x1, 0xABCD)))
    assert 'ATTRS{idVendor}=="0001", ATTRS{idProduct}=="abcd"' in fault[1]
    with pytest.raises(DeviceError, match="run `groundstation devices`"):
        open_port(pty.path, "thing", 9600)


class FakeList:
    def __init__(self, *ports):
        self.ports = [
            type("Port", (), dict(zip(("device", "vid", "pid", "serial_number"), p, strict=True)))
            for p in ports
        ]

    def comports(self):
        return self.ports


def test_ports_are_found_by_identity_path_and_serial_number(monkeypatch, pty):
    listed = FakeList(
        ("/dev/ttyUSB9", 1, 2, "B"),
        ("/dev/ttyUSB1", 1, 2, "A"),
        ("/dev/ttyACM0", 1, 3, None),
        ("/dev/ttyS0", None, None, None),
    )
    monkeypatch.setattr("serial.tools.list_ports.comports", listed.comports)
    ids = (UsbId(1, 2), UsbId(1, 3))
    assert find_port("", "thing", *ids) == ("/dev/ttyACM0", "")
    assert find_port("", "thing", ids[0]) == ("/dev/ttyUSB1", "A")
    assert find_port("B", "thing", *ids) == ("/dev/ttyUSB9", "B")
    assert find_port("/dev/ttyUSB9", "thing", *ids) == ("/dev/ttyUSB9", "B")
    assert find_port(pty.path, "thing", *ids) == (pty.path, "")
    with pytest.raises(DeviceError, match="/dev/none: there is no such serial port"):
        find_port("/dev/none", "thing", *ids)
    with pytest.raises(DeviceError, match="C: no thing with this serial number; connected: A, B"):
        find_port("C", "thing", ids[0])
    with pytest.raises(DeviceError, match=r"No thing is connected \(USB 0009:0009\)"):
        find_port("", "thing", UsbId(9, 9))


@given(st.binary(max_size=100), st.integers(0, 2**32))
def test_a_sound_line_changes_nothing_and_a_bad_one_keeps_the_order(data, seed):
    assert Faults().spoil(data) == data
    marked = bytes(range(len(data)))
    come = Faults(0.1, 0.1, 0.02, Random(seed)).spoil(marked)
    assert list(come) == sorted(come)


def test_shares_are_as_asked():
    data = bytes(10) * 10_000
    dropped, doubled = Faults(drop=0.01), Faults(duplicate=0.01)
    assert len(dropped.spoil(data)) == len(data) - dropped.events
    assert len(doubled.spoil(data)) == len(data) + doubled.events
    assert 800 < dropped.events < 1200
    assert len(Faults(truncate=0.01).spoil(data)) < 2_000


def test_an_unknown_emulator_is_told_with_those_there_are():
    with pytest.raises(DeviceError, match=r"no such emulator; use one of: .*falcon"):
        make_emulator("flacon", time.monotonic)
    assert emulator_names() == sorted(BUILT_IN)


def test_a_served_falcon_is_flown_through_its_uri(tmp_path):
    """Both in real time, as a user runs them: what `--device` gets is what the emulator says."""
    emulator = make_emulator("falcon", time.monotonic, "circle")
    serving = threading.Event()
    serving.set()
    server = threading.Thread(target=serve, args=(emulator, serving.is_set))
    server.start()
    try:
        device = make_device(emulator.uri)
        device.open()
        homed = until(lambda: (device.read().homed, device.write_force(ZERO3), time.sleep(1e-3))[0])
        device.close()
        assert homed
    finally:
        serving.clear()
        server.join()
        emulator.close()
    assert not Path(emulator.uri.partition(":")[2]).exists()
