"""From the handle to p_h and ṗ_h: both mappings, the clutch, switches without a jump, the leash."""

from itertools import pairwise
from math import dist, hypot, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3, HandleState
from groundstation.config import Limits, Mapping
from groundstation.messages import MappingMode
from groundstation.pilot.choices import Choices
from groundstation.pilot.reference import Reference, ReferenceGenerator

DT, WORKSPACE = 0.001, 0.1
P = (1.0, 2.0, 3.0, 0.0)
RATE, POSITION = Choices(), Choices(mapping=MappingMode.POSITION)


class Bench:
    """A generator with a handle and a vehicle that stands where it stands, or follows."""

    def __init__(self, *, follows: bool = True, **mapping) -> None:
        self.generator = ReferenceGenerator(Mapping(**mapping), Limits(), WORKSPACE)
        self.p, self.follows = P, follows
        self.handle = ZERO3
        self.before = self.generator.begun(self.p, self.state(ZERO3), RATE)

    def state(self, velocity, yaw=0.0) -> HandleState:
        return HandleState(self.handle, velocity, yaw, 0, homed=True, device_time=0.0)

    def to(self, place, seconds, choices=RATE, yaw=0.0, share=1.0) -> list[Reference]:
        """Move the handle there evenly, and return every tick's reference."""
        ticks = round(seconds / DT)
        begin = self.handle
        velocity = tuple((b - a) / seconds for a, b in zip(begin, place, strict=True))
        seen = []
        for tick in range(1, ticks + 1):
            self.handle = tuple(a + v * tick * DT for a, v in zip(begin, velocity, strict=True))
            hand = self.state(velocity, yaw)
            self.before = self.generator.step(self.before, hand, choices, self.p, dt=DT, share=share)
            if self.follows:
                self.p = self.before.p_h
            seen.append(self.before)
        self.handle = place
        return seen


def test_in_position_mode_p_h_moves_as_the_handle_does_scaled_on_each_axis() -> None:
    bench = Bench(scale=(20.0, 10.0, 5.0), frame="world")
    ended = bench.to((0.05, -0.05, 0.02), 0.5, POSITION)[-1]
    assert ended.p_h == pytest.approx((2.0, 1.5, 3.1, 0.0))
    # ṗ_h is the handle's velocity, scaled: 0.1 m/s · 20 forward.
    assert ended.rate[:3] == pytest.approx((2.0, -1.0, 0.2))


def test_in_the_heading_frame_forward_moves_p_h_where_the_drone_looks() -> None:
    bench = Bench(scale=(20.0, 20.0, 10.0), frame="heading")
    bench.p = (*P[:3], pi / 2)
    bench.before = bench.generator.begun(bench.p, bench.state(ZERO3), POSITION)
    assert bench.to((0.05, 0.0, 0.0), 0.5, POSITION)[-1].p_h[:3] == pytest.approx((1.0, 3.0, 3.0))


def test_the_clutch_lets_the_handle_go_back_as_a_mouse_is_lifted() -> None:
    bench = Bench(scale=(20.0, 20.0, 10.0))
    bench.to((0.08, 0.0, 0.0), 0.5, POSITION)
    lifted = bench.to((-0.08, 0.0, 0.0), 0.5, POSITION._replace(clutched=True))
    assert all(tick.p_h == pytest.approx((2.6, 2.0, 3.0, 0.0)) for tick in lifted)
    assert lifted[-1].rate == pytest.approx((0.0,) * 4)
    assert bench.to((0.08, 0.0, 0.0), 0.5, POSITION)[-1].p_h[0] == pytest.approx(2.6 + 0.16 * 20)


def test_fine_leaves_a_share_of_scale_and_speed() -> None:
    bench = Bench(scale=(20.0, 20.0, 10.0), fine=0.25, deadband=0.0, expo=0.0)
    assert bench.to((0.04, 0.0, 0.0), 0.5, POSITION._replace(fine=True))[-1].p_h[0] == pytest.approx(1.2)
    held = Bench(fine=0.25, deadband=0.0, expo=0.0, speed=(2.0, 2.0, 1.0, 0.8))
    held.to((0.1, 0.0, 0.0), 0.1)
    assert held.to((0.1, 0.0, 0.0), 1.5, RATE._replace(fine=True))[-1].rate[0] == pytest.approx(0.5)


def test_rate_mode_moves_p_h_as_a_drone_can() -> None:
    bench = Bench(deadband=0.0, expo=0.0)
    bench.handle = (0.1, 0.0, 0.0)
    seen = bench.to((0.1, 0.0, 0.0), 1.5)
    assert seen[-1].rate[0] == pytest.approx(2.0)
    rates = [tick.rate[0] for tick in seen]
    assert max(b - a for a, b in pairwise(rates)) <= Limits().acceleration * DT * (1 + 1e-9)


def test_the_deadband_is_silent_in_rate_mode_and_unknown_in_position_mode() -> None:
    assert Bench(deadband=0.1).to((0.009, 0.0, 0.0), 0.5)[-1].p_h == pytest.approx(P)
    assert Bench(deadband=0.1).to((0.009, 0.0, 0.0), 0.5, POSITION)[-1].p_h[0] > P[0]


def jumps(seen: list[Reference]) -> float:
    """Return the largest step of p_h in one tick, m."""
    return max(dist(a.p_h[:3], b.p_h[:3]) for a, b in pairwise(seen))


@pytest.mark.parametrize("to_position", [True, False])
def test_the_mapping_is_switched_in_flight_without_a_jump(to_position: bool) -> None:
    bench = Bench()
    first, then = (RATE, POSITION) if to_position else (POSITION, RATE)
    seen = bench.to((0.08, 0.0, 0.0), 0.5, first)
    seen += bench.to((0.08, 0.0, 0.0), 1.5, first)
    seen += bench.to((0.08, 0.0, 0.0), 1.5, then)
    assert jumps(seen) <= 3.3 * DT


def test_after_a_switch_to_rate_mode_the_handle_takes_hold_in_its_centre() -> None:
    bench = Bench()
    bench.to((0.08, 0.0, 0.0), 0.5, POSITION)
    away = bench.to((0.08, 0.0, 0.0), 1.0, RATE)
    assert all(tick.waiting for tick in away)
    assert dist(away[0].p_h, away[-1].p_h) < 0.002
    back = bench.to((0.0, 0.0, 0.0), 0.5, RATE)
    assert not back[-1].waiting
    assert bench.to((0.08, 0.0, 0.0), 1.0, RATE)[-1].rate[0] > 1.0


def test_the_clutch_in_rate_mode_stops_p_h_gently_and_takes_hold_in_the_centre() -> None:
    bench = Bench()
    bench.to((0.1, 0.0, 0.0), 2.0)
    held = bench.to((0.1, 0.0, 0.0), 1.5, RATE._replace(clutched=True))
    assert held[-1].rate == pytest.approx((0.0,) * 4)
    assert bench.to((0.1, 0.0, 0.0), 0.5)[-1].rate == pytest.approx((0.0,) * 4)


def test_buttons_turn_a_handle_without_rotation() -> None:
    left = Bench().to(ZERO3, 1.5, RATE._replace(turn=1))[-1]
    assert left.rate[3] == pytest.approx(Mapping().speed[3])
    assert Bench().to(ZERO3, 1.5, RATE._replace(turn=-1))[-1].rate[3] == pytest.approx(-Mapping().speed[3])
    clutched = RATE._replace(turn=1, clutched=True)
    assert Bench().to(ZERO3, 1.5, clutched)[-1].rate[3] == 0.0


@pytest.mark.parametrize("choices", [RATE, POSITION])
def test_the_leash_winds_nothing_up(choices: Choices) -> None:
    bench = Bench(follows=False, scale=(100.0, 100.0, 100.0))
    bench.to((0.1, 0.0, 0.0), 1.0, choices)
    out = bench.to((0.1, 0.0, 0.0), 1.0, choices)[-1]
    assert dist(out.p_h[:3], P[:3]) <= Mapping().leash + 1e-9
    assert hypot(out.p_h[0] - P[0]) == pytest.approx(Mapping().leash)
    # Giving way is felt at once: nothing has to be unwound first.
    bench.to((-0.1, 0.0, 0.0), 0.02, choices)
    assert bench.to((-0.1, 0.0, 0.0), 0.3, choices)[-1].p_h[0] < out.p_h[0] - 0.05


moves = st.lists(
    st.tuples(
        st.tuples(*[st.floats(-0.05, 0.05)] * 3),
        st.builds(
            Choices,
            mapping=st.sampled_from(MappingMode),
            fine=st.booleans(),
            clutched=st.booleans(),
            turn=st.sampled_from([-1, 0, 1]),
        ),
    ),
    min_size=1,
    max_size=6,
)


@given(moves, st.booleans())
def test_whatever_is_switched_when_p_h_never_jumps_nor_leaves_the_leash(moves: list, follows: bool) -> None:
    bench = Bench(follows=follows)
    for place, choices in moves:
        before = bench.before
        seen = [before, *bench.to(place, 0.05, choices)]
        # Rate mode alone moves by 3 m/s at most; the handle's own motion is scaled by 20.
        own = (
            dist(place, before.handle) / 0.05 * 20.0 * DT if choices.mapping is MappingMode.POSITION else 0.0
        )
        assert jumps(seen) <= 3.4 * DT + own * 1.001 + 1e-9
        assert all(dist(tick.p_h[:3], P[:3]) <= Mapping().leash + 1e-9 for tick in seen if not follows)
