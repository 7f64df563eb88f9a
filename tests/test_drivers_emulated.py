"""A double with its driver, as a real process behind a real port: it moves, yields, dies, ends with its holder."""

import time
from pathlib import Path

import pytest

from drivers.device import ZERO3, DeviceError
from drivers.emulated import Emulated
from drivers.stick import StickSender

PATIENCE_S = 20.0


def eventually(look, what):
    """Return what `look` returns once it is something; the device is read meanwhile, as a servo does."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        try:
            if found := look():
                return found
        except DeviceError:
            pass
        time.sleep(0.002)
    raise AssertionError(what)


@pytest.fixture
def falcon(tmp_path):
    device = Emulated(f"falcon@{tmp_path / 'hand.sock'}")
    device.open()
    yield device
    device.close()


def test_the_hand_moves_and_yields_through_the_falcons_bytes(falcon, tmp_path):
    sender = StickSender(str(tmp_path / "hand.sock"))

    def held(place, force):
        sender.send(place, 0.0, 0, time.monotonic())
        falcon.write_force(force)
        return falcon.read()

    eventually(lambda: held(ZERO3, ZERO3).homed, "homed")
    eventually(lambda: held((0.02, 0.0, 0.0), ZERO3).position[0] > 0.019, "moved")
    eventually(lambda: held((0.02, 0.0, 0.0), (-2.0, 0.0, 0.0)).position[0] < 0.01, "pushed back")
    sender.close()


def test_a_double_that_dies_is_a_device_that_is_lost_and_comes_back(falcon):
    eventually(falcon.read, "there")
    assert falcon._process is not None
    falcon._process.kill()

    def lost():
        try:
            falcon.read()
        except DeviceError:
            return True
        return False

    eventually(lost, "lost")
    falcon.close()
    falcon.open()
    eventually(falcon.read, "there again")


def test_closing_leaves_no_process(falcon):
    assert falcon._process is not None
    pid = falcon._process.pid
    falcon.close()
    falcon.close()
    assert not Path(f"/proc/{pid}").exists()
    with pytest.raises(DeviceError, match="not open"):
        falcon.read()


@pytest.mark.parametrize(
    ("address", "why"), [("theremin@/x", "no such emulator; use one of: .*falcon"), ("falcon", "SOCKET")]
)
def test_what_is_no_emulator_is_refused(address, why):
    with pytest.raises(DeviceError, match=why):
        Emulated(address)


def test_a_socket_that_cannot_be_is_told():
    device = Emulated("falcon@/nowhere/at/all.sock")
    with pytest.raises(DeviceError, match="/nowhere/at/all"):
        device.open()
