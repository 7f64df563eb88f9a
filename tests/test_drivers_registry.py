"""From a URI to a device."""

from __future__ import annotations

import importlib
import subprocess
import sys

import pytest

from drivers.device import DeviceError
from drivers.discovery import discover_all
from drivers.registry import BUILT_IN, driver_module, make_device
from drivers.scripted import ScriptedHand
from drivers.virtual import VirtualHandle


@pytest.fixture
def other_package(tmp_path, monkeypatch):
    """Another package with drivers, found through real distribution metadata."""
    (tmp_path / "knob_driver.py").write_text(
        "from drivers.discovery import Found\n"
        "class Knob:\n"
        "    def __init__(self, address, *, gain=1.0, ticks=24):\n"
        "        self.address, self.gain, self.ticks = address, gain, ticks\n"
        "def discover(*, gain=1.0):\n"
        "    if gain < 0:\n"
        "        raise RuntimeError('a bug of theirs')\n"
        "    return [Found('knob', 'knob:1', f'Knob x{gain}', '1', '/dev/knob', 'rumble', 500.0)]\n"
    )
    info = tmp_path / "knob-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: knob\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[groundstation.drivers]\nknob = knob_driver:Knob\nbroken = knob_driver:Nothing\n"
        "gone = not_installed_at_all:Thing\nvirtual = knob_driver:Knob\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    yield
    sys.modules.pop("knob_driver", None)


@pytest.mark.parametrize(("name", "kind"), [("virtual", VirtualHandle), ("scripted", ScriptedHand)])
def test_our_own_are_made_with_their_address(name, kind, tmp_path):
    path = tmp_path / "with:colon"
    device = make_device(f"{name}:{path}")
    assert isinstance(device, kind)
    device.open()
    assert path.is_socket()
    device.close()


def test_another_packages_driver_is_found_and_gets_the_address(other_package):
    device = make_device("knob:/dev/ttyUSB0:115200")
    assert type(device).__name__ == "Knob"
    assert device.address == "/dev/ttyUSB0:115200"
    assert make_device("knob").address == ""


def test_another_package_cannot_take_the_place_of_ours(other_package, tmp_path):
    assert isinstance(make_device(f"virtual:{tmp_path / 'stick'}"), VirtualHandle)


@pytest.mark.parametrize("name", ["broken", "gone"])
def test_a_driver_that_does_not_load_is_explained(other_package, name):
    with pytest.raises(DeviceError, match=rf"^{name}: its driver .* cannot be loaded"):
        make_device(name)


@pytest.mark.parametrize("uri", ["nothing", "nothing:here", "", ":x"])
def test_an_unknown_driver_is_told_with_those_there_are(other_package, uri):
    known = ", ".join(sorted({*BUILT_IN, "broken", "gone", "knob"}))
    with pytest.raises(DeviceError, match=f"use one of: {known}\\."):
        make_device(uri)


@pytest.mark.parametrize("uri", ["virtual", "virtual:", "scripted"])
def test_a_missing_path_is_told(uri):
    with pytest.raises(DeviceError, match="path of its socket"):
        make_device(uri)


def test_no_driver_is_imported_before_it_is_asked_for(tmp_path):
    program = f"""
import sys
from drivers.registry import make_device
assert not {{"drivers.virtual", "drivers.scripted"}} & set(sys.modules)
make_device("virtual:{tmp_path}/stick")
assert "drivers.scripted" not in sys.modules
"""
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_settings_reach_the_driver_that_knows_them(other_package):
    device = make_device("knob:x", {"gain": 2.5})
    assert (device.gain, device.ticks) == (2.5, 24)


def test_an_unknown_setting_is_told_with_the_known_ones(other_package, tmp_path):
    with pytest.raises(DeviceError, match=r"devices.knob.gian: .* it has: gain, ticks\."):
        make_device("knob", {"gian": 1.0})
    with pytest.raises(DeviceError, match=r"devices.virtual.clock: .* it has none\."):
        make_device(f"virtual:{tmp_path}/stick", {"clock": 3})


def test_all_that_drivers_find_is_listed_and_one_that_fails_hides_no_other(other_package):
    found = discover_all({"broken": {"gain": 3.0, "ticks": 12}})
    (knob,) = [device for device in found if device.driver == "knob"]
    assert (knob.name, knob.usable, knob.uri) == ("Knob x3.0", True, "knob:1")
    (gone,) = [device for device in found if device.driver == "gone"]
    assert not gone.usable
    assert "ModuleNotFoundError" in gone.why
    assert gone.remedy == "reinstall its package"
    (knob,) = [device for device in discover_all({"broken": {"gain": -1.0}}) if device.driver == "broken"]
    assert (knob.usable, knob.why) == (False, "its driver fails (RuntimeError: a bug of theirs)")


def test_our_own_drivers_all_look_for_devices_or_have_none_to_look_for():
    for name in BUILT_IN:
        module = importlib.import_module(driver_module(name))
        assert hasattr(module, "discover") != (
            name in {"emulated", "scripted", "virtual", "virtual-joystick"}
        )
