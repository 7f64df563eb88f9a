"""Whatever a driver says, field by field: what cannot be never reaches the controller, and is told once."""

from math import inf, nan

import pytest

from drivers.device import ZERO3, DeviceInfo, HandleState
from groundstation.devices.keeper import RETRY_S, DeviceKeeper
from groundstation.devices.sanity import impossible, unusable

INFO = DeviceInfo("Odd device", "7", 4, 0.1, 10.0, 1000.0, 1000.0, "force")
GOOD = HandleState((0.01, 0.02, -0.03), (0.1, 0.0, -0.2), 0.2, 1, homed=True, device_time=9.999)
NOW = 10.0
WRONG = {
    "position": [
        (nan, 0.0, 0.0),
        (0.0, inf, 0.0),
        (0.0, 0.0, -inf),
        (10.0, 0.0, 0.0),
        (0.0, 0.0),
        "abc",
        None,
    ],
    "velocity": [(nan, 0.0, 0.0), (0.0, inf, 0.0), (0.0, 0.0, 100.0), (0.0,), (0.0, 0.0, 0.0, 0.0), 3.0],
    "yaw": [nan, inf, 90.0, "left", None],
    "buttons": [-1, 1 << 40, None],
    "device_time": [nan, inf, NOW + 1e6, "now", None],
}
CASES = [(field, value) for field, values in WRONG.items() for value in values]


class Device:
    """A third party's driver that says what it is told to say."""

    def __init__(self):
        self.info = INFO
        self.says = GOOD
        self.forces = []

    def open(self):
        pass

    def read(self):
        return self.says

    def write_force(self, force):
        self.forces.append(force)

    def close(self):
        pass


@pytest.mark.parametrize(("field", "value"), CASES, ids=[f"{field}-{value}" for field, value in CASES])
def test_one_impossible_field_makes_the_handle_absent_and_is_told_once(field, value):
    device, said, now = Device(), [], NOW
    keeper = DeviceKeeper(
        device, lambda severity, words: said.append(words), lambda: now, lambda work: work()
    )
    keeper.read(now)
    assert keeper.read(now) == GOOD
    said.clear()
    device.says = GOOD._replace(**{field: value})
    for _ in range(1000):
        now += 0.001
        assert keeper.read(now) is None
        keeper.write((1.0, 0.0, 0.0))
    assert device.forces == []
    assert len(said) == 1
    assert "Odd device" in said[0]
    device.says = GOOD._replace(device_time=now)
    while now < NOW + 2.0 + RETRY_S:
        now += 0.001
        device.says = GOOD._replace(device_time=now)
        keeper.read(now)
    assert keeper.present


def test_what_a_hand_can_do_is_believed():
    assert impossible(GOOD, INFO, NOW) == ""
    corner = GOOD._replace(position=(0.1, 0.1, 0.1), velocity=(8.0, -3.0, 2.0), yaw=-3.1)
    assert impossible(corner, INFO, NOW) == ""


@pytest.mark.parametrize(
    "changed", [{"workspace": 0.0}, {"workspace": nan}, {"force_limit": -1.0}, {"rate": inf}, {"rate": 0.0}]
)
def test_a_device_that_is_impossible_in_itself_is_not_opened(changed):
    fields = ("name", "serial", "axes", "workspace", "force_limit", "stiffness_limit", "rate", "renders")
    odd = DeviceInfo(**({name: getattr(INFO, name) for name in fields} | changed))
    assert unusable(odd)
    device, said = Device(), []
    device.info = odd
    keeper = DeviceKeeper(
        device, lambda _severity, words: said.append(words), lambda: NOW, lambda work: work()
    )
    assert [keeper.read(NOW + 0.01 * tick) for tick in range(100)] == [None] * 100
    assert len(said) == 1
    assert ZERO3 not in device.forces
