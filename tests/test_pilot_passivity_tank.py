"""The two-layer energy tank: its level is never negative, damping fills it, and what is in it is rendered."""

from math import hypot

import pytest
from haptic_loop import DEVICE, DT
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3, Vector3
from groundstation.pilot.passivity.choice import passivity_named
from groundstation.pilot.passivity.gains import physical_damping
from groundstation.pilot.passivity.port import CREDIT, STORE, Port
from groundstation.pilot.passivity.tank import DESIRED, level

DAMPING = physical_damping(DEVICE)
TANK = passivity_named("tank", DEVICE)
FORCES = st.tuples(*[st.floats(-20, 20)] * 3)
PLACES = st.tuples(*[st.floats(-0.2, 0.2)] * 3)
VELOCITIES = st.tuples(*[st.floats(-3, 3)] * 3)


def rendered(level: float, wanted: Vector3, velocity: Vector3) -> Port:
    return TANK.rendered(Port(energy=level - CREDIT), wanted, velocity, DT, 0.1)


@pytest.mark.parametrize("share", [0.1, 0.5, 1.0, 3.0])
def test_the_damping_grows_as_the_level_sinks_below_the_one_desired(share: float) -> None:
    """By hand: α (H_d − H), an empty tank's being the device's own limit."""
    force = rendered(share * DESIRED, (0.1, 1.0, 0.0), (0.1, 0.0, 0.0)).force
    assert force == pytest.approx((0.1 - DAMPING * max(0.0, 1.0 - share) * 0.1, 1.0, 0.0))


def test_damping_fills_the_tank_and_then_lets_go() -> None:
    port, x = Port(), 0.0
    levels = [level(port)]
    for _ in range(3000):
        x += 0.3 * DT
        port = TANK.rendered(TANK.observed(port, (x, 0.0, 0.0)), ZERO3, (0.3, 0.0, 0.0), DT, 0.1)
        levels.append(level(port))
    assert levels == sorted(levels)
    # H → H_d with the time constant H_d/(b v²) = 0.44 s.
    assert levels[1000] == pytest.approx(0.9 * DESIRED, rel=0.03)
    assert levels[-1] == pytest.approx(DESIRED, rel=0.01)


def test_a_full_tank_is_no_fuller_than_the_store() -> None:
    port = TANK.observed(Port(force=(-10.0, 0.0, 0.0)), (1.0, 0.0, 0.0))
    assert level(port) == pytest.approx(STORE + CREDIT)


def test_an_empty_tank_holds_nothing_that_could_give() -> None:
    assert rendered(0.0, (3.0, 3.0, 0.0), ZERO3).force == ZERO3
    assert rendered(0.0, (3.0, 3.0, 0.0), (0.01, 0.0, 0.0)).force == ZERO3


@given(st.lists(st.tuples(FORCES, PLACES, VELOCITIES), max_size=30))
def test_the_level_is_never_negative_whatever_the_hand_does(scenes: list) -> None:
    """The hand jumps as no hand can, against all that is seen of it: what was overdrawn is a debt, paid off first."""
    port = Port()
    for wanted, place, velocity in scenes:
        port = TANK.rendered(port, wanted, velocity, DT, 0.1)
        before, work = (
            level(port),
            sum(f * (b - a) for f, a, b in zip(port.force, port.position, place, strict=True)),
        )
        port = TANK.observed(port, place)
        assert 0.0 <= level(port) <= STORE + CREDIT
        assert level(port) <= max(0.0, before - work) + 1e-12
        if level(port) == 0.0:
            empty = TANK.rendered(port, wanted, velocity, DT, 0.1).force
            assert sum(f * v for f, v in zip(empty, velocity, strict=True)) <= 0.0
            assert hypot(*empty) == 0.0 or hypot(*velocity) > 0.0
