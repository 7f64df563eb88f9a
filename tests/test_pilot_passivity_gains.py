"""The bounds of a sampled spring: which gains a device renders passively."""

import pytest
from haptic_loop import DEVICE

from drivers.device import DeviceInfo
from groundstation.config import Control, Cues, Mapping, Settings
from groundstation.messages import MappingMode
from groundstation.pilot.passivity.gains import (
    largest_damping,
    largest_stiffness,
    passive_gains,
    physical_damping,
)


def test_the_bounds_of_a_sampled_spring() -> None:
    """By hand: 3 kN/m at 1 kHz means b = 1.5 N·s/m; beside 0.5 N·s/m at 500 Hz, K < 2 · 500 · 1.0."""
    falcon = DeviceInfo("test", "", 3, 0.04, 8.0, 3000.0, 1000.0, "force")
    assert physical_damping(falcon) == pytest.approx(1.5)
    assert largest_stiffness(falcon, 1000.0, 0.0) == pytest.approx(3000.0)
    assert largest_stiffness(falcon, 500.0, 0.5) == pytest.approx(1000.0)
    assert largest_stiffness(falcon, 1000.0, 2.0) == 0.0
    assert largest_damping(falcon, 1000.0, 0.0) == pytest.approx(1.5)
    assert largest_damping(falcon, 500.0, 1000.0) == pytest.approx(0.5)
    assert largest_damping(falcon, 100.0, 1000.0) == 0.0


def test_gains_that_the_device_renders_passively_stay_as_they_are() -> None:
    control = Settings().control
    assert passive_gains(Settings(), DEVICE, MappingMode.RATE) == (control.stiffness, control.damping, 1.0)


def test_gains_that_it_does_not_are_brought_down_spring_first() -> None:
    """By hand: 400 N/m at 2 m/s over 0.1 m is 8 N/m within a tick; b of a weak device at 1 kHz is 0.002 N·s/m."""
    weak = DeviceInfo("test", "", 3, 0.1, 8.0, 4.0, 1000.0, "force")
    settings = Settings(control=Control(stiffness=(400.0, 400.0, 200.0), damping=1.0))
    gains = passive_gains(settings, weak, MappingMode.RATE)
    assert gains.share == 0.5
    assert gains.stiffness == pytest.approx((200.0, 200.0, 100.0))
    assert gains.damping == 0.0
    strong = DeviceInfo("test", "", 3, 0.1, 8.0, 1000.0, 1000.0, "force")
    assert passive_gains(settings, strong, MappingMode.RATE).damping == pytest.approx(0.5 - 0.004)


def test_in_position_mode_the_scale_and_the_environment_make_the_spring() -> None:
    """By hand: (4 + 5) N/m · 20 = 180 N/m at the handle, of 1,000; where 45 are allowed, a quarter of all springs."""
    settings = Settings(mapping=Mapping(scale=(20.0, 20.0, 10.0)), cues=Cues(environment=5.0))
    strong = DeviceInfo("test", "", 3, 0.1, 8.0, 1000.0, 1000.0, "force")
    gains = passive_gains(settings, strong, MappingMode.POSITION)
    assert gains == (settings.control.stiffness, pytest.approx(min(0.4, 0.5 - 0.09)), 1.0)
    weak = DeviceInfo("test", "", 3, 0.1, 8.0, 45.0, 1000.0, "force")
    gains = passive_gains(settings, weak, MappingMode.POSITION)
    assert gains.share == pytest.approx(0.25)
    assert gains.stiffness == pytest.approx((1.0, 1.0, 1.0))
    assert gains.damping == 0.0


def test_a_force_that_is_only_drawn_needs_no_bound() -> None:
    drawn = DeviceInfo("test", "", 3, 0.1, 0.0, 0.0, 100.0, "nothing")
    control = Settings().control
    assert passive_gains(Settings(), drawn, MappingMode.RATE) == (control.stiffness, control.damping, 1.0)
