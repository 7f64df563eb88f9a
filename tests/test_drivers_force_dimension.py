"""Force Dimension: the driver the real `forcedimension-core` on a library compiled here in the SDK's place."""

from __future__ import annotations

import ctypes
import math
import os
import platform
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from drivers.device import ZERO3, DeviceError
from drivers.force_dimension import ForceDimension

TICK = 1e-3

# What the library keeps to itself: what it is to say, and what it was told. Doubles in SDK's frame and units.
STUB = """
double place[3] = {0, 0, 0}, speed[3] = {0, 0, 0}, force[3] = {0, 0, 0}, frame[9] = {1,0,0, 0,1,0, 0,0,1};
int present = 1, initialized = 1, enabled = 0, opened = 0, buttons = 0, wrist = 0, failing = 0, velocities = 1;
int dhdGetSDKVersion(int *a, int *b, int *c, int *d) { *a = 3; *b = 17; *c = 0; *d = 0; return 0; }
int dhdGetDeviceCount(void) { return present; }
int dhdGetAvailableCount(void) { return present - opened; }
int dhdOpen(void) { if (!present) return -1; opened = 1; return 0; }
int dhdOpenSerial(int serial) { return serial == 4711 ? dhdOpen() : -1; }
int dhdClose(char id) { opened = 0; return 0; }
int dhdGetSerialNumber(unsigned short *serial, char id) { *serial = 4711; return 0; }
const char *dhdGetSystemName(char id) { return "omega.6"; }
const char *dhdErrorGetLastStr(void) { return "no device found"; }
int dhdHasWrist(char id) { return wrist; }
int dhdEnableForce(unsigned char on, char id) { enabled = on; return 0; }
int dhdGetButtonMask(char id) { return buttons; }
int dhdGetPosition(double *x, double *y, double *z, char id)
{ *x = place[0]; *y = place[1]; *z = place[2]; return failing ? -1 : 0; }
int dhdGetLinearVelocity(double *x, double *y, double *z, char id)
{ *x = speed[0]; *y = speed[1]; *z = speed[2]; return velocities ? 0 : -1; }
int dhdGetOrientationFrame(double *out, char id) { for (int i = 0; i < 9; i++) out[i] = frame[i]; return 0; }
int dhdSetForce(double x, double y, double z, char id)
{ force[0] = x; force[1] = y; force[2] = z; return failing ? -1 : 0; }
int drdIsInitialized(char id) { return initialized; }
"""


@pytest.fixture(scope="session")
def sdk(tmp_path_factory):
    """A folder laid out like the SDK, with a library that has every function the package looks up."""
    compiler = shutil.which("cc")
    package = Path(find_spec("forcedimension_core").origin).parent
    assert compiler, "these tests need a C compiler: apt-get install gcc"
    names = {
        name
        for file in package.rglob("*.py")
        for name in re.findall(r"_lib(?:dhd|drd)\.(\w+)", file.read_text(encoding="utf-8"))
    }
    others = names - set(re.findall(r"(\w+)\(", STUB))
    folder = tmp_path_factory.mktemp("sdk")
    place = folder / "lib" / "release" / f"lin-{platform.machine()}-gcc"
    place.mkdir(parents=True)
    source = folder / "stub.c"
    source.write_text(STUB + "".join(f"int {name}(void) {{ return 0; }}\n" for name in sorted(others)))
    command = [compiler, "-shared", "-fPIC", "-w", "-o", str(place / "libdrd.so.3"), str(source)]
    subprocess.run(command, check=True)
    return folder


class Stub:
    """The variables of the library."""

    def __init__(self, path):
        self._library = ctypes.CDLL(str(path))

    def __setattr__(self, name, value):
        if name.startswith("_"):
            super().__setattr__(name, value)
        elif isinstance(value, int):
            ctypes.c_int.in_dll(self._library, name).value = value
        else:
            (ctypes.c_double * len(value)).in_dll(self._library, name)[:] = value

    @property
    def force(self):
        return tuple((ctypes.c_double * 3).in_dll(self._library, "force"))

    def number(self, name):
        return ctypes.c_int.in_dll(self._library, name).value


@pytest.fixture
def stub(sdk, monkeypatch):
    monkeypatch.setenv("FDSDK", str(sdk))
    stub = Stub(next(sdk.rglob("libdrd.so.3")))
    stub.present = stub.initialized = stub.velocities = 1
    stub.enabled = stub.opened = stub.buttons = stub.wrist = stub.failing = 0
    for name in ("place", "speed", "force"):
        setattr(stub, name, (0.0, 0.0, 0.0))
    stub.frame = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    return stub


class Clock:
    def __init__(self):
        self.now = 50.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def device(stub, clock):
    device = ForceDimension("", clock)
    device.open()
    yield device
    device.close()


def test_it_says_what_it_is(device, stub):
    assert (device.info.name, device.info.serial, device.info.axes) == ("Force Dimension omega.6", "4711", 3)
    assert device.info.force_limit == 12.0
    assert stub.number("enabled") == 1


def test_it_reads_in_the_handles_frame(device, stub):
    stub.place, stub.speed, stub.buttons = (-0.03, 0.02, 0.01), (0.1, -0.2, 0.3), 5
    state = device.read()
    assert state.position == pytest.approx((0.03, -0.02, 0.01))
    assert state.velocity == pytest.approx((-0.1, 0.2, 0.3))
    assert (state.buttons, state.homed, state.yaw) == (5, True, 0.0)
    assert state.device_time == device._clock.now


def test_a_wrist_gives_yaw(stub, clock):
    stub.wrist = 1
    stub.frame = (math.cos(0.4), -math.sin(0.4), 0, math.sin(0.4), math.cos(0.4), 0, 0, 0, 1)
    device = ForceDimension("4711", clock)
    device.open()
    assert device.info.axes == 4
    assert device.read().yaw == pytest.approx(0.4)
    device.close()


def test_force_is_turned_and_limited(device, stub):
    device.read()
    device.write_force((1.0, 2.0, 3.0))
    assert stub.force == (-1.0, -2.0, 3.0)
    device.write_force((0.0, 300.0, 400.0))
    assert stub.force == pytest.approx((0.0, -7.2, 9.6))


def test_not_initialized_is_not_homed_and_presses_nothing(device, stub, clock):
    stub.initialized = 0
    assert not device.read().homed
    device.write_force((1.0, 0.0, 0.0))
    assert stub.force == ZERO3
    stub.initialized = 1
    clock.now += 0.02
    assert device.read().homed


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_force_that_is_not_a_number_becomes_none(device, stub, bad):
    device.read()
    device.write_force((1.0, 0.0, 0.0))
    with pytest.raises(DeviceError, match="not a number"):
        device.write_force((0.0, bad, 0.0))
    assert stub.force == ZERO3


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 30.0, 1e300])
@pytest.mark.parametrize("field", ["place", "speed"])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_measurement_that_cannot_be_is_passed_over_and_then_an_error(device, stub, clock, bad, field, axis):
    good = device.read()
    values = [0.0, 0.0, 0.0]
    values[axis] = bad
    setattr(stub, field, values)
    clock.now += TICK
    assert device.read() == good
    assert device.refused == 1
    clock.now += 0.06
    with pytest.raises(DeviceError, match="cannot be"):
        device.read()


def test_a_yaw_that_is_not_a_number_is_passed_over(stub, clock):
    stub.wrist = 1
    device = ForceDimension("", clock)
    device.open()
    device.read()
    stub.frame = (math.nan,) * 9
    assert device.read().yaw == 0.0
    assert device.refused == 1
    device.close()


def test_no_velocity_yet_is_none(device, stub):
    stub.speed, stub.velocities = (9.0, 9.0, 9.0), 0
    assert device.read().velocity == pytest.approx(ZERO3)


def test_a_device_that_fails_is_an_error_at_once(device, stub):
    stub.failing = 1
    with pytest.raises(DeviceError, match="does not answer"):
        device.read()
    with pytest.raises(DeviceError, match="does not answer"):
        device.write_force(ZERO3)


def test_closing_ends_the_force_and_may_be_done_twice(device, stub):
    device.read()
    device.write_force((1.0, 0.0, 0.0))
    device.close()
    assert stub.force == ZERO3
    assert (stub.number("enabled"), stub.number("opened")) == (0, 0)
    device.close()
    with pytest.raises(DeviceError, match="not open"):
        device.read()


def test_no_device_is_told(stub):
    stub.present = 0
    with pytest.raises(DeviceError, match="No Force Dimension device can be opened"):
        ForceDimension("").open()
    with pytest.raises(DeviceError, match="device 99 can be opened"):
        ForceDimension("99").open()
    with pytest.raises(DeviceError, match="no serial number"):
        ForceDimension("/dev/ttyUSB0")


def test_they_are_discovered(stub):
    from drivers.force_dimension import discover

    (found,) = discover()
    assert (found.usable, found.renders, found.uri) == (True, "force", "force-dimension")
    stub.opened = 1
    (found,) = discover()
    assert (found.usable, "another program" in found.why) == (False, True)
    stub.present = stub.opened = 0
    assert discover() == []


MISSING = """
import sys
{without}
from drivers.force_dimension import ForceDimension, discover
from drivers.device import DeviceError
(found,) = discover()
assert not found.usable and {remedy!r} in found.remedy, found
for _ in range(2):
    try:
        ForceDimension("").open()
    except DeviceError as error:
        assert {remedy!r} in str(error), error
    else:
        raise AssertionError
"""


@pytest.mark.parametrize(
    ("without", "remedy"),
    [
        ('sys.modules["forcedimension_core"] = None', "groundstation[force-dimension]"),
        ("", "set FDSDK"),
    ],
)
def test_without_package_or_sdk_it_says_what_to_install_and_nothing_else(without, remedy, tmp_path):
    environment = {"PATH": os.environ["PATH"], "HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    program = MISSING.format(without=without, remedy=remedy)
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, check=False, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
