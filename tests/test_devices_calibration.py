"""Calibrations: measured, kept in files, applied to what a real driver reads."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState
from drivers.stick import StickSender
from drivers.virtual import VirtualHandle
from groundstation.devices.calibration import (
    Calibrated,
    Calibration,
    applied,
    calibration_path,
    load_calibration,
    measured,
    save_calibration,
)
from groundstation.errors import InputError

STICK = DeviceInfo("Stick", "A-1", 4, 0.1, 10.0, 0.0, 100.0, "nothing")
FORCE = DeviceInfo("Haptic", "B/2", 3, 0.04, 8.0, 3000.0, 1000.0, "force")
NUMBERS = st.tuples(*[st.floats(-10, 10)] * 3)
SCALES = st.tuples(*[st.floats(0.2, 5.0)] * 3)


@given(st.text(max_size=20), NUMBERS, SCALES)
def test_a_calibration_survives_its_file(tmp_path_factory, name, center, scale):
    path = tmp_path_factory.getbasetemp() / "round.toml"
    calibration = Calibration(name, "2026-11-22T05:00:00+00:00", center, scale)
    save_calibration(path, calibration)
    assert load_calibration(path) == calibration


def test_each_serial_number_has_its_own_and_none_leaves_the_folder():
    folder = Path("/somewhere")
    assert calibration_path(folder, "falcon", "").name == "falcon-any.toml"
    assert calibration_path(folder, "falcon", "X12").name == "falcon-X12.toml"
    assert calibration_path(folder, "falcon", "../../etc/passwd").parent == folder


def test_a_file_that_cannot_be_used_is_told_of(tmp_path):
    path = tmp_path / "bad.toml"
    assert load_calibration(path) is None
    for text in ("center = [", "name = 'x'", "name = 'x'\nmade = ''\nscale = [9.0, 1.0, 1.0]"):
        path.write_text(text)
        with pytest.raises(InputError, match="calibrate"):
            load_calibration(path)


def test_a_device_that_renders_force_gets_its_centre_only():
    made = measured(FORCE, "now", [(0.001, -0.002, 0.0), (0.0012, -0.0018, 0.0)], [])
    assert made.center == pytest.approx((0.0011, -0.0019, 0.0))
    assert made.scale == (1.0, 1.0, 1.0)


def test_a_stick_gets_its_travel_scaled_by_the_shorter_side():
    swept = [(0.06, 0.09, 0.0), (-0.05, -0.1, 0.0), (0.0, 0.0, 0.0)]
    made = measured(STICK, "now", [(0.01, 0.0, 0.0)] * 3, swept)
    # x: +0.05 and −0.06 from its centre; y: +0.09 and −0.10; z was not moved and is left alone.
    assert made.scale == pytest.approx((2.0, 0.1 / 0.09, 1.0))


@pytest.mark.parametrize(
    ("resting", "swept", "why"),
    [
        ([(0.0, 0.0, 0.0), (0.01, 0.0, 0.0)], [], "moved"),
        ([(0.06, 0.0, 0.0)] * 2, [], "off its middle"),
        ([ZERO3] * 2, [(0.015, 0.0, 0.0), (-0.015, 0.0, 0.0)], "all the way"),
    ],
)
def test_what_was_not_done_right_is_refused(resting, swept, why):
    with pytest.raises(InputError, match=why):
        measured(STICK, "now", resting, swept)


def test_position_and_velocity_are_those_of_the_calibrated_handle():
    state = HandleState((0.03, 0.0, -0.01), (0.1, 0.2, 0.3), 0.5, 3, homed=True, device_time=1.0)
    seen = applied(Calibration("x", "", (0.01, 0.0, 0.01), (2.0, 1.0, 0.5)), state)
    assert seen.position == pytest.approx((0.04, 0.0, -0.01))
    assert seen.velocity == pytest.approx((0.2, 0.2, 0.15))
    assert (seen.yaw, seen.buttons, seen.homed, seen.device_time) == (0.5, 3, True, 1.0)


def test_a_calibration_made_is_there_after_the_next_opening(tmp_path):
    socket, now = str(tmp_path / "hand.sock"), 5.0
    device = Calibrated(VirtualHandle(socket, lambda: now), "virtual", tmp_path)
    device.open()
    sender = StickSender(socket)
    sender.send((0.02, 0.0, 0.0), 0.0, 0, now)
    assert device.read().position == pytest.approx((0.02, 0.0, 0.0))
    save_calibration(
        calibration_path(tmp_path, "virtual", ""), Calibration("x", "", (0.005, 0.0, 0.0), (2.0, 1.0, 1.0))
    )
    device.close()
    device.open()
    sender.send((0.02, 0.0, 0.0), 0.0, 0, now)
    assert device.read().position == pytest.approx((0.03, 0.0, 0.0))
    device.write_force((1.0, 0.0, 0.0))
    device.close()
    calibration_path(tmp_path, "virtual", "").write_text("nonsense")
    with pytest.raises(DeviceError, match="calibrate"):
        device.open()
    device.close()
    sender.close()
