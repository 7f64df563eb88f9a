"""The haptic port gives the hand no net energy, whatever the link does, in any mode but off."""

from itertools import pairwise
from math import dist, hypot, inf, nan

import pytest
from haptic_loop import DEVICE, DT, LOOSE, Link, least_energy
from hypothesis import example, given
from hypothesis import strategies as st

from drivers.arm import Arm
from drivers.device import ZERO3, DeviceInfo
from groundstation.pilot.passivity.bounds import ACCELERATION
from groundstation.pilot.passivity.choice import passivity_named
from groundstation.pilot.passivity.gains import physical_damping
from groundstation.pilot.passivity.off import Off
from groundstation.pilot.passivity.port import CREDIT, STORE, Port, looked

MODES = ("observer", "wave", "tank")
DAMPING = physical_damping(DEVICE)
UNSEEN = 0.5 * ACCELERATION * DT * DT
FORCES = st.tuples(*[st.floats(-12, 12)] * 3)
VELOCITIES = st.tuples(*[st.floats(-3, 3)] * 3)
DELAYS = st.one_of(st.floats(0, 1.5), st.just(nan))
every_mode = pytest.mark.parametrize("mode", MODES)


def rough(delay: float) -> Link:
    return Link(delay, jitter=0.5, loss=0.3, blackout=(2.0, 2.4))


@every_mode
@pytest.mark.parametrize(("delay", "arm"), [(0.0, LOOSE), (0.1, Arm()), (0.7, LOOSE)])
def test_no_delay_jitter_loss_or_blackout_gives_the_hand_energy(mode, delay: float, arm: Arm) -> None:
    assert least_energy(rough(delay), passivity=mode, seconds=4.0, arm=arm) >= -1e-3


@pytest.mark.parametrize("delay", [0.0, 0.7])
def test_off_really_is_off_and_the_same_runs_give_it(delay: float) -> None:
    assert least_energy(rough(delay), passivity="off", seconds=4.0) < -0.05


@pytest.mark.parametrize("mode", [*MODES, "off"])
def test_the_account_is_the_work_of_the_held_force(mode) -> None:
    observed = passivity_named(mode, DEVICE).observed
    port = Port(energy=0.01, position=(0.01, 0.0, 0.0), force=(-2.0, 1.0, 0.0))
    pushed = observed(port, (0.03, 0.0, 0.05))
    assert pushed.energy == pytest.approx(0.01 + 2.0 * 0.02)
    assert pushed.position == (0.03, 0.0, 0.05)
    assert pushed.force == port.force
    assert observed(port, (-1.0, 0.0, 0.0)).energy == pytest.approx(0.01 - 2.0 * 1.01)
    assert observed(port._replace(energy=STORE), (0.03, 0.0, 0.0)).energy == STORE


def test_off_gives_every_force_as_it_is_wanted() -> None:
    off = passivity_named("off", DEVICE)
    port = off.rendered(Port(energy=-1.0), (8.0, 3.0, 0.0), (0.2, 0.0, 0.0), DT, nan)
    assert port.force == (8.0, 3.0, 0.0)
    assert port.dissipated == 0.0


@every_mode
@pytest.mark.parametrize("renders", ["rumble", "nothing"])
def test_a_device_without_force_needs_none(mode, renders) -> None:
    assert isinstance(passivity_named(mode, DeviceInfo("test", "", 3, 0.1, 1.0, 1.0, 100.0, renders)), Off)


@every_mode
@pytest.mark.parametrize("delay", [0.0, 0.7, nan])
def test_a_hand_at_rest_feels_the_whole_force_for_ever(mode, delay: float) -> None:
    passivity, port = passivity_named(mode, DEVICE), Port()
    for _ in range(3000):
        port = passivity.rendered(passivity.observed(port, ZERO3), (8.0, 0.0, 3.0), ZERO3, DT, delay)
        assert port.force == (8.0, 0.0, 3.0)


@every_mode
def test_a_hand_that_gives_way_until_nothing_is_left_feels_it_all_again_at_rest(mode) -> None:
    passivity, port, x = passivity_named(mode, DEVICE), Port(), 0.0
    felt = []
    for _ in range(1500):
        x += 0.1 * DT
        port = passivity.rendered(
            passivity.observed(port, (x, 0.0, 0.0)), (8.0, 0.0, 0.0), (0.1, 0.0, 0.0), DT, 0.3
        )
        felt.append(port.force[0])
    assert felt[-1] <= 1e-3
    # It fades, and does not come and go: no tick takes more than a tenth of what there was.
    assert all(abs(after - before) <= 0.1 * abs(before) + 1e-3 for before, after in pairwise(felt))
    port = passivity.rendered(passivity.observed(port, (x, 0.0, 0.0)), (8.0, 0.0, 0.0), ZERO3, DT, 0.3)
    assert port.force == (8.0, 0.0, 0.0)


@every_mode
def test_a_force_that_brakes_is_never_touched(mode) -> None:
    port = Port(energy=-1e-4)
    braking = passivity_named(mode, DEVICE).rendered(port, (-8.0, 0.0, 0.0), (0.4, 0.0, 0.0), DT, 0.1)
    assert braking.force == (-8.0, 0.0, 0.0)
    assert braking.dissipated == 0.0


@every_mode
def test_what_a_late_tick_overdrew_is_repaid_by_braking(mode) -> None:
    """A force held too long has given 50 mJ: pushes render nothing, the hand's own work is taken until it is paid."""
    passivity = passivity_named(mode, DEVICE)
    port = passivity.observed(Port(force=(5.0, 0.0, 0.0)), (0.01, 0.0, 0.0))
    assert port.energy == pytest.approx(-0.05)
    port = passivity.rendered(port, (8.0, 0.0, 0.0), ZERO3, DT, 0.1)
    assert port.force == ZERO3
    x = 0.01
    for _ in range(100):
        x += 0.2 * DT
        port = passivity.rendered(
            passivity.observed(port, (x, 0.0, 0.0)), (-8.0, 0.0, 0.0), (0.2, 0.0, 0.0), DT, 0.1
        )
        assert port.force[0] < 0.0
    assert port.energy == pytest.approx(-0.05 + 8.0 * 99 * 0.2 * DT)


@every_mode
@pytest.mark.parametrize("broken", [nan, inf])
def test_what_is_not_finite_is_not_booked_and_not_rendered(mode, broken: float) -> None:
    passivity = passivity_named(mode, DEVICE)
    port = Port(energy=0.01, force=(3.0, 0.0, 0.0))
    assert passivity.observed(port, (broken, 0.0, 0.0)) == port
    rendered = passivity.rendered(port, (3.0, 0.0, 0.0), (0.0, broken, 0.0), DT, 0.1)
    assert rendered.force == ZERO3
    assert rendered.dissipated == 0.0


@every_mode
@example(-2e-3, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 0.0)
@given(st.floats(-0.002, 0.3), FORCES, VELOCITIES, DELAYS)
def test_what_is_rendered_never_gives_more_than_what_is_wanted(mode, energy, wanted, velocity, delay) -> None:
    force = passivity_named(mode, DEVICE).rendered(Port(energy=energy), wanted, velocity, DT, delay).force
    power = sum(f * v for f, v in zip(force, velocity, strict=True))
    asked = sum(f * v for f, v in zip(wanted, velocity, strict=True))
    assert power <= max(asked, 0.0) + 1e-9
    assert power * DT <= max(energy + CREDIT, 0.0) + 1e-9
    # Only along the motion does it brake, by no more than the device's own damping.
    assert power >= min(asked, -DAMPING * sum(v * v for v in velocity)) - 1e-9
    assert hypot(*force) <= max(hypot(*wanted), DAMPING * hypot(*velocity)) + 1e-9
    assert dist(force, wanted) <= 2.0 * hypot(*wanted) + DAMPING * hypot(*velocity) + 1e-9


scenes = st.lists(st.tuples(FORCES, VELOCITIES, st.floats(0, 1), DELAYS, st.integers(1, 30)), max_size=12)


@every_mode
@given(scenes)
def test_no_motion_that_a_servo_can_foresee_draws_more_than_the_credit(mode, scenes: list) -> None:
    """The hand moves as it is seen to, and beside it by r = ½ a dt² at most, to where the force gives most."""
    passivity, port = passivity_named(mode, DEVICE), Port()
    given_to_hand = 0.0
    for wanted, velocity, luck, delay, ticks in scenes:
        for _ in range(ticks):
            port = passivity.rendered(port, wanted, velocity, DT, delay)
            strength = max(hypot(*port.force), 1e-12)
            moved = [v * DT + luck * UNSEEN * f / strength for v, f in zip(velocity, port.force, strict=True)]
            given_to_hand += sum(f * d for f, d in zip(port.force, moved, strict=True))
            port = passivity.observed(port, tuple(a + d for a, d in zip(port.position, moved, strict=True)))
            assert given_to_hand <= CREDIT + 1e-9
            assert port.energy >= -CREDIT - 1e-9


@every_mode
@given(scenes)
def test_no_motion_draws_more_than_the_credit_though_the_device_is_silent_for_some_ticks(
    mode, scenes: list
) -> None:
    """A cable that falters: the last sample is all there is, and the hand moves on, to where the force gives most."""
    passivity, port, sampled = passivity_named(mode, DEVICE), Port(), 0.0
    for wanted, velocity, luck, delay, ticks in scenes:
        sampled += DT
        for tick in range(ticks):
            port = looked(port, sampled, DT)
            assert port.unseen == pytest.approx(tick * DT)
            port = passivity.rendered(port, wanted, velocity, DT, delay)
            if tick < ticks - 1:
                port = passivity.observed(port, port.position)
        span, strength = ticks * DT, max(hypot(*port.force), 1e-12)
        beside = luck * 0.5 * ACCELERATION * span * span / strength
        moved = [v * span + beside * f for v, f in zip(velocity, port.force, strict=True)]
        port = passivity.observed(port, tuple(a + d for a, d in zip(port.position, moved, strict=True)))
        assert port.energy >= -CREDIT - 1e-9


@every_mode
def test_the_force_comes_back_with_the_next_sample(mode) -> None:
    passivity = passivity_named(mode, DEVICE)
    port, wanted = Port(), (8.0, 0.0, 3.0)
    for sampled in (0.1, *[0.2] * 50, 0.3):
        port = passivity.rendered(looked(port, sampled, DT), wanted, ZERO3, DT, 0.1)
        if port.unseen > 0.01:
            assert hypot(*port.force) < 0.2
    assert port.force == wanted
