"""Time-domain passivity: what the account does not cover is taken out along the motion."""

import pytest
from haptic_loop import DEVICE, DT

from drivers.device import ZERO3, Vector3
from groundstation.pilot.passivity.choice import passivity_named
from groundstation.pilot.passivity.gains import physical_damping
from groundstation.pilot.passivity.port import CREDIT, Port

DAMPING = physical_damping(DEVICE)


def rendered(energy: float, wanted: Vector3, velocity: Vector3) -> Port:
    return passivity_named("observer", DEVICE).rendered(Port(energy=energy), wanted, velocity, DT, 0.1)


def test_a_force_along_the_motion_is_paid_for_from_the_account() -> None:
    assert rendered(0.17, (8.0, 0.0, 0.0), (0.2, 0.0, 0.0)).force == (8.0, 0.0, 0.0)
    poor = rendered(0.0, (8.0, 3.0, 0.0), (0.2, 0.0, 0.0))
    # 0.4 mJ are spent over 0.1 s: 0.02 N along 20 mm; what is across stays.
    assert poor.force == pytest.approx((0.02, 3.0, 0.0))
    assert poor.dissipated == pytest.approx(7.98 * 0.2 * DT)


def test_an_account_overdrawn_is_damped_as_strongly_as_the_device_can() -> None:
    overdrawn = rendered(-6e-4, (5.0, 0.0, 0.0), (0.2, 0.0, 0.0))
    assert overdrawn.force == pytest.approx((-DAMPING * 0.2, 0.0, 0.0))


def test_an_account_at_its_end_renders_nothing_across_either() -> None:
    assert rendered(-CREDIT, (0.0, 8.0, 0.0), ZERO3).force == ZERO3
