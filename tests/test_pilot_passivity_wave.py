"""Wave variables: the port as the end of a transmission line, and energy that comes back after a round trip."""

from math import inf, nan, sqrt

import pytest
from haptic_loop import DEVICE, DT
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3, Vector3
from groundstation.pilot.passivity.choice import passivity_named
from groundstation.pilot.passivity.gains import physical_damping
from groundstation.pilot.passivity.line import PACKETS, UNKNOWN, Line, carried, exchanged
from groundstation.pilot.passivity.port import Port

IMPEDANCE = physical_damping(DEVICE)
WAVE = passivity_named("wave", DEVICE)
RICH = Port(energy=0.1, line=Line(returned=0.1))


def rendered(port: Port, wanted: Vector3, velocity: Vector3, delay: float = 0.2) -> Vector3:
    return WAVE.rendered(port, wanted, velocity, DT, delay).force


@given(st.floats(0.0, 2.5), st.floats(0.0, 0.3))
def test_the_port_is_the_end_of_a_line_of_its_impedance(wanted: float, speed: float) -> None:
    """F·v = ½ (u² − w²), with √(2b) w the force wanted."""
    force = rendered(RICH, (wanted, 0.0, 0.0), (speed, 0.0, 0.0))[0]
    root = sqrt(2.0 * IMPEDANCE)
    u, w = (IMPEDANCE * speed - force) / root, (IMPEDANCE * speed + force) / root
    assert root * w == pytest.approx(wanted, abs=1e-9)
    assert 0.5 * (u * u - w * w) == pytest.approx(-force * speed, abs=1e-9)


def test_without_energy_only_the_matched_impedance_is_felt() -> None:
    spent = Port(energy=-4e-4, line=Line(returned=-4e-4))
    # The wave is weakened as a whole: what is left of it is what the line's damping pays for in this tick.
    force = rendered(spent, (8.0, 4.0, 0.0), (0.2, 0.0, 0.0))
    share = IMPEDANCE * 0.2 / 8.0
    assert force == pytest.approx((0.0, 4.0 * share, 0.0), abs=1e-9)
    deeper = Port(energy=-6e-4, line=Line(returned=-6e-4))
    assert rendered(deeper, (8.0, 4.0, 0.0), (0.2, 0.0, 0.0)) == pytest.approx((-IMPEDANCE * 0.2, 0.0, 0.0))


def test_what_the_hand_gave_is_felt_again_only_after_the_round_trip() -> None:
    """It gives 40 mJ within 50 ms and then moves with the force: at first on credit, later on what has come back."""
    delay, port, x = 0.4, Port(), 0.0
    for _ in range(50):
        x += 0.1 * DT
        port = WAVE.rendered(WAVE.observed(port, (x, 0.0, 0.0)), (-8.0, 0.0, 0.0), (0.1, 0.0, 0.0), DT, delay)
    port = WAVE.observed(port, (x, 0.0, 0.0))
    assert port.energy == pytest.approx(8.0 * 0.1 * 0.049)
    for _ in range(round(delay / PACKETS / DT)):
        # The packet leaves while the hand rests.
        port = WAVE.rendered(WAVE.observed(port, (x, 0.0, 0.0)), ZERO3, ZERO3, DT, delay)
    felt = []
    for _ in range(800):
        x -= 0.01 * DT
        port = WAVE.rendered(
            WAVE.observed(port, (x, 0.0, 0.0)), (-4.0, 0.0, 0.0), (-0.01, 0.0, 0.0), DT, delay
        )
        felt.append(-port.force[0])
    gone, back = felt[200:290], felt[420:]
    assert max(gone) < 0.1
    assert min(back) == pytest.approx(4.0 - 0.01 * IMPEDANCE)


@given(st.floats(0.0, 1.5))
def test_energy_comes_back_no_sooner_than_the_round_trip_and_at_most_a_quarter_later(delay: float) -> None:
    line, t = exchanged(Line(), 1.0), 0.0
    while line.returned == 0.0:
        line, t = carried(line, DT, delay, inf), t + DT
    assert line.returned == 1.0
    assert delay - 1e-9 <= t <= (1.0 + 1.0 / PACKETS) * delay + (PACKETS + 1) * DT + 1e-9


def test_while_the_round_trip_is_not_known_it_is_taken_for_a_long_one() -> None:
    line, ticks = exchanged(Line(), 1.0), 0
    while line.returned == 0.0:
        line, ticks = carried(line, DT, nan, inf), ticks + 1
    assert ticks * DT >= UNKNOWN


def test_what_has_not_left_yet_is_taken_out_first() -> None:
    """So a hand that trembles under a force spends nothing."""
    line = exchanged(exchanged(Line(returned=0.01), 2e-3), -2e-3)
    assert line == Line(returned=0.01)
    assert exchanged(line, -0.02).returned == pytest.approx(-0.01)


@given(st.lists(st.tuples(st.floats(-0.1, 0.1), st.floats(0.0, 1.0), st.integers(1, 20)), max_size=20))
def test_the_line_keeps_every_joule(acts: list) -> None:
    line, total = Line(), 0.0
    for sent, delay, ticks in acts:
        line, total = exchanged(line, sent), total + sent
        for _ in range(ticks):
            line = carried(line, DT, delay, inf)
        assert line.packet + sum(line.under_way) + line.returned == pytest.approx(total, abs=1e-9)
        assert min(line.packet, *line.under_way) >= 0.0


def test_of_what_has_come_back_it_keeps_no_more_than_the_store() -> None:
    line = exchanged(Line(), 1.0)
    for _ in range(20):
        line = carried(line, DT, 0.0, 0.2)
    assert line.returned == 0.2
