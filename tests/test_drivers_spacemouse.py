"""The SpaceMouse: raw reports through the real `pyspacemouse`; only the HID device under it is ours."""

from __future__ import annotations

import math
import struct
import subprocess
import sys
from types import SimpleNamespace

import pyspacemouse
import pytest
from easyhid import HIDException
from hypothesis import given
from hypothesis import strategies as st

from drivers import spacemouse
from drivers.device import ZERO3, DeviceError
from drivers.spacemouse import WORKSPACE, SpaceMouse

COMPACT = (0x256F, 0xC635)
FULL = 350


class Hid:
    """What `easyhid` gives: a device with a queue of reports, each read padded to the size that was asked for."""

    manufacturer_string, product_string, release_number = "3Dconnexion", "SpaceMouse Compact", 0x0437

    def __init__(self, path, identity=COMPACT):
        self.path = path
        self.vendor_id, self.product_id = identity
        self.serial_number = "K7"
        self.reports = []
        self.gone = False
        self.is_open = False

    def open(self):
        if self.gone:
            raise HIDException("Failed to open device")
        self.is_open = True

    def close(self):
        self.is_open = False

    def set_nonblocking(self, enable):
        assert enable is True

    def read(self, size):
        if self.gone:
            raise HIDException("Failed to read from HID device: -1")
        return bytearray(self.reports.pop(0)[:size].ljust(size, b"\0")) if self.reports else bytearray()


class Clock:
    def __init__(self):
        self.now = 50.0

    def __call__(self):
        return self.now


@pytest.fixture
def bus(monkeypatch):
    """The HID devices that are plugged in."""
    devices = []
    listing = SimpleNamespace(find=lambda: list(devices), device_list=devices)
    monkeypatch.setattr("pyspacemouse.api.Enumeration", lambda: listing)
    return devices


@pytest.fixture
def hid(bus, tmp_path):
    path = tmp_path / "hidraw3"
    path.touch()
    bus.append(Hid(str(path)))
    return bus[0]


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def device(hid, clock, capsys):
    device = SpaceMouse("", clock)
    device.open()
    yield device
    device.close()
    assert capsys.readouterr().out == ""


def shift(x, y, z):
    """A report of translation as HID has it: x right, y toward the user, z down."""
    return struct.pack("<B3h", 1, x, y, z)


def twist(roll, pitch, yaw):
    return struct.pack("<B3h", 2, roll, pitch, yaw)


def test_a_cap_pushed_away_flies_forward(device, hid, clock):
    hid.reports.append(shift(0, -FULL, 0))
    state = device.read()
    assert state.position == pytest.approx((WORKSPACE, 0.0, 0.0))
    assert state.device_time == clock.now
    assert state.homed


def test_all_axes_and_buttons(device, hid):
    hid.reports += [shift(-70, -35, -140), twist(100, 100, -175), bytes([3, 0b10, 0])]
    state = device.read()
    assert state.position == pytest.approx((0.01, 0.02, 0.04))
    assert state.yaw == pytest.approx(0.5)
    assert state.buttons == 0b10
    assert (device.info.name, device.info.axes, device.info.renders) == ("SpaceMouseCompact", 4, "nothing")


@given(st.lists(st.binary(max_size=20), max_size=20))
def test_no_report_breaks_it_or_leaves_the_workspace(tmp_path_factory, reports):
    path = tmp_path_factory.mktemp("hid") / "hidraw0"
    path.touch()
    hid = Hid(str(path))
    with pytest.MonkeyPatch.context() as patch:
        listing = SimpleNamespace(find=lambda: [hid], device_list=[hid])
        patch.setattr("pyspacemouse.api.Enumeration", lambda: listing)
        device = SpaceMouse("", Clock())
        device.open()
    hid.reports = [report for report in reports if report]
    state = device.read()
    assert math.hypot(*state.position) <= WORKSPACE * (1 + 1e-12)
    assert abs(state.yaw) <= spacemouse.FULL_YAW
    assert all(map(math.isfinite, state.velocity))
    device.close()


def test_a_report_that_cannot_be_is_passed_over_and_then_an_error(device, hid, clock):
    hid.reports += [shift(0, -35, 0), shift(0, -30000, 0)]
    assert device.read().position == pytest.approx((0.01, 0.0, 0.0))
    assert device.refused == 1
    clock.now += 0.25
    with pytest.raises(DeviceError, match="silent"):
        device.read()
    hid.reports.append(shift(0, 0, 0))
    assert device.read().position == pytest.approx(ZERO3)


def test_at_rest_it_may_be_silent_and_displaced_it_may_not(device, hid, clock):
    clock.now += 100.0
    assert device.read().position == ZERO3
    assert device.read().device_time == clock.now
    hid.reports.append(shift(0, -35, 0))
    device.read()
    clock.now += 0.19
    assert device.read().device_time == pytest.approx(clock.now - 0.19)
    clock.now += 0.02
    with pytest.raises(DeviceError, match="silent"):
        device.read()
    hid.reports.append(shift(0, -35, 0))
    assert device.read().position == pytest.approx((0.01, 0.0, 0.0))


def test_many_reports_at_once_are_all_taken_and_the_newest_counts(device, hid):
    hid.reports += [shift(0, -step, 0) for step in range(20)]
    assert device.read().position == pytest.approx((0.1 * 19 / FULL, 0.0, 0.0))
    hid.reports += [shift(0, 0, 0)] * 1000
    device.read()
    assert len(hid.reports) == 1000 - spacemouse.MOST_REPORTS


def test_it_knows_its_speed(device, hid, clock):
    for step in range(100):
        clock.now += 0.008
        hid.reports.append(shift(0, -3 * step, 0))
        state = device.read()
    assert state.velocity == pytest.approx((0.1 * 3 / FULL / 0.008, 0.0, 0.0), rel=1e-3, abs=1e-9)


def test_unplugging_is_an_error_at_once_and_plugging_in_again_offers_it_again(device, hid):
    hid.gone = True
    with pytest.raises(DeviceError, match="gone"):
        device.read()
    with pytest.raises(DeviceError, match="cannot be opened"):
        device.open()
    hid.gone = False
    device.open()
    assert device.read().homed


def test_force_is_not_rendered_and_what_is_no_number_is_refused(device):
    device.write_force((1.0, 0.0, 0.0))
    for bad in (math.nan, math.inf):
        with pytest.raises(DeviceError, match="not a number"):
            device.write_force((0.0, bad, 0.0))


def test_closing_may_be_done_twice(device, hid):
    device.close()
    device.close()
    assert not hid.is_open
    with pytest.raises(DeviceError, match="not open"):
        device.read()
    with pytest.raises(DeviceError, match="not open"):
        device.write_force(ZERO3)


def test_none_is_told(bus):
    with pytest.raises(DeviceError, match="No SpaceMouse is connected"):
        SpaceMouse("").open()
    assert spacemouse.discover() == []


def test_the_one_that_is_meant_is_opened(hid, bus, tmp_path):
    other = tmp_path / "hidraw1"
    other.touch()
    bus.append(Hid(str(other), (0x46D, 0xC626)))
    for address, meant in (("", bus[1]), (str(other), bus[1]), ("compact", hid), (hid.path, hid)):
        device = SpaceMouse(address)
        device.open()
        assert meant.is_open
        device.close()
    with pytest.raises(DeviceError, match="Pilot: no SpaceMouse is known by this; connected: SpaceNavigator"):
        SpaceMouse("Pilot").open()


def test_they_are_discovered_with_what_hinders(hid, bus, monkeypatch):
    bus.append(Hid("/dev/null", (0x1234, 0x5678)))
    (found,) = spacemouse.discover()
    assert (found.name, found.uri, found.usable) == ("SpaceMouseCompact", f"spacemouse:{hid.path}", True)
    monkeypatch.setattr(spacemouse.os, "access", lambda path, mode: False)
    (found,) = spacemouse.discover()
    assert not found.usable
    assert "udev" in found.remedy
    hid.gone = True
    with pytest.raises(DeviceError, match="may not read.*udev"):
        SpaceMouse("").open()


def test_without_hidapi_it_says_what_to_install(monkeypatch):
    def missing():
        raise AttributeError("hid_enumerate")

    monkeypatch.setattr(pyspacemouse.api, "Enumeration", missing)
    (found,) = spacemouse.discover()
    assert (found.usable, found.remedy) == (False, "sudo apt-get install libhidapi-hidraw0")
    with pytest.raises(DeviceError, match="apt-get install libhidapi-hidraw0"):
        SpaceMouse("").open()


def test_without_its_package_it_says_what_to_install():
    program = """
import sys
sys.modules["pyspacemouse"] = None
from drivers.spacemouse import SpaceMouse, discover
from drivers.device import DeviceError
(found,) = discover()
assert not found.usable and "groundstation[spacemouse]" in found.remedy, found
try:
    SpaceMouse("").open()
except DeviceError as error:
    assert "groundstation[spacemouse]" in str(error)
else:
    raise AssertionError
"""
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
