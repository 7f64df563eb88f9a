"""The haptic port gives the hand no net energy, whatever the link does; and the bounds of a sampled spring."""

from math import dist, hypot

import pytest
from haptic_loop import DEVICE, DT, LOOSE, Link, least_energy
from hypothesis import given
from hypothesis import strategies as st

from drivers.arm import Arm
from drivers.device import ZERO3, DeviceInfo
from groundstation.config import Control, Settings
from groundstation.pilot.passivity import (
    CREDIT,
    STORE,
    Port,
    largest_damping,
    largest_stiffness,
    observed,
    passive,
    passive_gains,
    physical_damping,
)

BROKEN = (4.0, 4.5)
FORCES = st.tuples(*[st.floats(-12, 12)] * 3)
VELOCITIES = st.tuples(*[st.floats(-3, 3)] * 3)
DAMPING = physical_damping(DEVICE)


@pytest.mark.parametrize("arm", [Arm(), LOOSE], ids=["arm", "loose"])
@pytest.mark.parametrize("delay", [0.0, 0.1, 0.35, 0.7])
def test_no_delay_jitter_loss_or_blackout_gives_the_hand_energy(delay: float, arm: Arm) -> None:
    link = Link(delay, jitter=0.5, loss=0.3, blackout=BROKEN)
    assert least_energy(link, passivity=True, seconds=8.0, arm=arm) >= -1e-3


@pytest.mark.parametrize("delay", [0.0, 0.35, 0.7])
def test_without_the_controller_the_same_runs_give_it(delay: float) -> None:
    link = Link(delay, jitter=0.5, loss=0.3, blackout=BROKEN)
    assert least_energy(link, passivity=False, seconds=8.0) < -0.05


def test_the_account_is_the_work_of_the_held_force() -> None:
    port = Port(energy=0.01, position=(0.01, 0.0, 0.0), force=(-2.0, 1.0, 0.0))
    pushed = observed(port, (0.03, 0.0, 0.05))
    assert pushed.energy == pytest.approx(0.01 + 2.0 * 0.02)
    assert pushed.position == (0.03, 0.0, 0.05)
    assert observed(port, (-1.0, 0.0, 0.0)).energy == pytest.approx(0.01 - 2.0 * 1.01)
    assert observed(port._replace(energy=STORE), (0.03, 0.0, 0.0)).energy == STORE


def test_a_hand_at_rest_feels_the_whole_force() -> None:
    assert passive(Port(), (8.0, 0.0, 0.0), ZERO3, DT, DAMPING).force == (8.0, 0.0, 0.0)


def test_a_force_that_brakes_is_never_touched() -> None:
    braking = passive(Port(energy=-1e-4), (-8.0, 0.0, 0.0), (0.4, 0.0, 0.0), DT, DAMPING)
    assert braking.force == (-8.0, 0.0, 0.0)


def test_a_force_along_the_motion_is_paid_for_from_the_account() -> None:
    rich = passive(Port(energy=0.1), (8.0, 0.0, 0.0), (0.2, 0.0, 0.0), DT, DAMPING)
    assert rich.force == (8.0, 0.0, 0.0)
    poor = passive(Port(), (8.0, 3.0, 0.0), (0.2, 0.0, 0.0), DT, DAMPING)
    # 0.4 mJ may be given in the tick: 2 N along 0.2 mm; what is across stays.
    assert poor.force == pytest.approx((2.0, 3.0, 0.0))
    assert poor.dissipated == pytest.approx(6.0 * 0.2 * DT)
    overdrawn = passive(Port(energy=-6e-4), (5.0, 0.0, 0.0), (0.2, 0.0, 0.0), DT, DAMPING)
    assert overdrawn.force == pytest.approx((-DAMPING * 0.2, 0.0, 0.0))


def test_an_account_at_its_end_renders_nothing_across_either() -> None:
    assert passive(Port(energy=-CREDIT), (0.0, 8.0, 0.0), (0.0, 0.0, 0.0), DT, DAMPING).force == ZERO3


@given(st.floats(-0.002, 0.3), FORCES, VELOCITIES)
def test_what_is_rendered_never_gives_more_than_what_is_wanted(energy, wanted, velocity) -> None:
    force = passive(Port(energy=energy), wanted, velocity, DT, DAMPING).force
    power = sum(f * v for f, v in zip(force, velocity, strict=True))
    asked = sum(f * v for f, v in zip(wanted, velocity, strict=True))
    assert power <= max(asked, 0.0) + 1e-9
    assert power * DT <= max(energy + CREDIT, 0.0) + 1e-9
    # Only along the motion does it brake, by no more than the device's own damping.
    assert hypot(*force) <= max(hypot(*wanted), DAMPING * hypot(*velocity)) + 1e-9
    assert dist(force, wanted) <= 2.0 * hypot(*wanted) + DAMPING * hypot(*velocity) + 1e-9


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
    assert passive_gains(Settings(), DEVICE) == (Settings().control.stiffness, Settings().control.damping)


def test_gains_that_it_does_not_are_brought_down_spring_first() -> None:
    """By hand: 400 N/m at 2 m/s over 0.1 m is 8 N/m within a tick; b of a weak device at 1 kHz is 0.002 N·s/m."""
    weak = DeviceInfo("test", "", 3, 0.1, 8.0, 4.0, 1000.0, "force")
    settings = Settings(control=Control(stiffness=(400.0, 400.0, 200.0), damping=1.0))
    gains = passive_gains(settings, weak)
    assert gains.stiffness == pytest.approx((200.0, 200.0, 100.0))
    assert gains.damping == 0.0
    strong = DeviceInfo("test", "", 3, 0.1, 8.0, 1000.0, 1000.0, "force")
    assert passive_gains(settings, strong).damping == pytest.approx(0.5 - 0.004)
