"""A device that seems unplugged for a while: to the keeper it is one that is gone and comes back."""

from pathlib import Path

import pytest

from drivers.device import ZERO3, DeviceError, Vector3
from drivers.stick import StickSender
from drivers.virtual import VirtualHandle
from groundstation.devices.keeper import RETRY_S, DeviceKeeper
from groundstation.devices.unpluggable import Unpluggable
from groundstation.messages import Severity

FORCE = (1.0, 2.0, 3.0)


class Noting(VirtualHandle):
    """The on-screen stick, with a note of the forces it is given."""

    def write_force(self, force: Vector3) -> None:
        super().write_force(force)
        self.forces.append(force)


class Bench:
    def __init__(self, path: Path):
        self.now = 50.0
        self.said = []
        self.device = Noting(str(path), lambda: self.now)
        self.device.forces = []
        self.unpluggable = Unpluggable(self.device, lambda: self.now)
        self.keeper = DeviceKeeper(
            self.unpluggable, lambda *said: self.said.append(said), lambda: self.now, lambda work: work()
        )
        self.sender = StickSender(str(path))

    def run(self, seconds):
        seen = []
        for _ in range(round(seconds / 0.01)):
            self.now += 0.01
            self.sender.send((0.01, 0.0, 0.0), 0.0, 0, self.now)
            seen.append(self.keeper.read(self.now) is not None)
            self.keeper.write(FORCE)
        return seen


@pytest.fixture
def bench(tmp_path):
    bench = Bench(tmp_path / "hand.sock")
    assert bench.run(2.0)[-1]
    bench.said.clear()
    yield bench
    bench.keeper.close()
    bench.sender.close()


def test_it_is_gone_for_so_long_told_once_and_there_again(bench):
    bench.unpluggable.unplug(5.0)
    assert not any(bench.run(4.9))
    assert not bench.keeper.present
    assert bench.said == [(Severity.WARNING, "The haptic device is gone; plug it in again.")]
    assert bench.run(2 * RETRY_S + 0.2)[-1]
    assert bench.said[1:] == [(Severity.INFO, "On-screen stick is there.")]


def test_no_force_stays_on_the_hand_and_none_comes_meanwhile(bench):
    assert bench.device.forces[-1] == FORCE
    bench.device.forces.clear()
    bench.unpluggable.unplug(5.0)
    bench.run(4.9)
    assert bench.device.forces == [ZERO3]


def test_it_may_be_plugged_in_before_its_time_and_one_that_is_there_feels_nothing_of_it(bench):
    bench.unpluggable.unplug(60.0)
    bench.run(1.0)
    bench.unpluggable.unplug(0.0)
    assert bench.run(2 * RETRY_S + 0.2)[-1]
    bench.device.forces.clear()
    bench.unpluggable.unplug(0.0)
    assert all(bench.run(0.1))
    assert set(bench.device.forces) == {FORCE}


def test_unplugged_it_cannot_be_opened_nor_take_a_force(bench):
    bench.unpluggable.unplug(1.0)
    for act in (bench.unpluggable.open, lambda: bench.unpluggable.write_force(FORCE)):
        with pytest.raises(DeviceError, match="plug it in again"):
            act()
