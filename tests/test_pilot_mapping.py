from math import dist, hypot, pi

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from groundstation.config import Mapping
from groundstation.pilot.controller import world_rates
from groundstation.pilot.mapping import RateMapping, advance, leashed

WORKSPACE = 0.1
angles = st.floats(-pi, pi)
mappings = st.builds(
    Mapping,
    frame=st.sampled_from(["world", "heading"]),
    deadband=st.floats(0, 0.5),
    expo=st.floats(0, 1),
    speed=st.tuples(*[st.floats(0.1, 10)] * 4),
    yaw_range=st.floats(0.1, 3),
)
positions = st.tuples(*[st.floats(-WORKSPACE, WORKSPACE)] * 3).filter(lambda p: hypot(*p) <= WORKSPACE)


def linear(frame: str = "world", deadband: float = 0.0) -> RateMapping:
    return RateMapping(
        Mapping(frame=frame, deadband=deadband, expo=0.0, speed=(2.0, 4.0, 1.0, 0.8), yaw_range=1.0),
        WORKSPACE,
    )


def test_half_the_travel_is_half_the_speed_of_the_axis() -> None:
    assert linear().rate((0.05, 0.0, 0.0), 0.0, 0.7) == pytest.approx((1.0, 0.0, 0.0, 0.0))
    assert linear().rate((0.0, -0.05, 0.0), 0.5, 0.7) == pytest.approx((0.0, -2.0, 0.0, 0.4))


def test_in_the_heading_frame_forward_is_where_the_drone_looks() -> None:
    assert linear("heading").rate((0.1, 0.0, 0.0), -1.0, pi / 2) == pytest.approx((0.0, 2.0, 0.0, -0.8))
    assert linear("heading").turn(0.7) == 0.7
    assert linear("world").turn(0.7) == 0.0


def test_expo_and_deadband_worked_by_hand() -> None:
    mapping = RateMapping(Mapping(frame="world", deadband=0.2, expo=0.5, speed=(2, 2, 2, 1)), WORKSPACE)
    # 0.06 m is 0.6 of the travel, (0.6 − 0.2)/0.8 = 0.5 past the deadband: 0.5·0.5 + 0.5·0.125 = 0.3125.
    assert mapping.rate((0.0, 0.0, 0.06), 0.0, 0.0)[2] == pytest.approx(0.625)
    assert mapping.rate((0.0, 0.0, 0.0199), 0.199, 0.0) == (0.0, 0.0, 0.0, 0.0)


def test_beyond_the_workspace_the_speed_stays_full() -> None:
    assert linear().rate((1.0, 0.0, 0.0), 3.0, 0.0) == pytest.approx((2.0, 0.0, 0.0, 0.8))


@given(mappings, positions, angles, angles)
def test_the_deadband_has_no_ridges_an_oblique_push_keeps_its_direction(
    mapping: Mapping, position: tuple, yaw: float, theta: float
) -> None:
    rate = RateMapping(mapping, WORKSPACE).rate(position, yaw, 0.0)
    shares = [rate[axis] / mapping.speed[axis] for axis in range(3)]
    strength = hypot(*shares)
    assert strength <= 1.0 + 1e-12
    if strength > 1e-9:
        for axis in range(3):
            assert shares[axis] / strength == pytest.approx(position[axis] / hypot(*position), abs=1e-9)


@given(mappings, st.floats(0, 1), st.floats(0, 1))
def test_further_out_is_never_slower(mapping: Mapping, one: float, other: float) -> None:
    near, far = sorted((one, other))
    rates = [RateMapping(mapping, WORKSPACE).rate((s * WORKSPACE, 0, 0), 0.0, 0.0)[0] for s in (near, far)]
    assert rates[0] <= rates[1] + 1e-12


@given(mappings, st.tuples(*[st.floats(-1, 1)] * 4), st.floats(0, 1), angles)
@example(Mapping(expo=5e-324), (1.0, 0.0, 0.0, 1.0), 0.5, 0.0)
@example(Mapping(expo=1.0 - 1e-16), (1.0, 0.0, 0.0, 1.0), 0.5, 0.0)
def test_the_displacement_for_a_rate_gives_that_rate(
    settings: Mapping, direction: tuple, strength: float, theta: float
) -> None:
    mapping = RateMapping(settings, WORKSPACE)
    size = max(hypot(*direction[:3]), 1.0)
    turn = theta if settings.frame == "heading" else 0.0
    shares = [part / size * strength for part in direction[:3]] + [direction[3]]
    wished = world_rates(tuple(s * v for s, v in zip(shares, settings.speed, strict=True)), turn)
    position, yaw = mapping.displacement_for(wished, theta)
    assert hypot(*position) <= WORKSPACE * (1 + 1e-9)
    assert mapping.rate(position, yaw, theta) == pytest.approx(wished, rel=1e-6, abs=1e-6)


@given(mappings, positions, st.floats(-1, 1), angles)
def test_the_rate_of_a_displacement_leads_back_to_it(
    settings: Mapping, position: tuple, share: float, theta: float
) -> None:
    mapping = RateMapping(settings, WORKSPACE)
    yaw = share * settings.yaw_range
    found, twist = mapping.displacement_for(mapping.rate(position, yaw, theta), theta)
    # In and just past the deadband the rate is nothing and leads to the centre.
    past = settings.deadband + 0.05
    if hypot(*position) > past * WORKSPACE:
        assert found == pytest.approx(position, abs=1e-6)
    if abs(share) > past:
        assert twist == pytest.approx(yaw, abs=1e-6)


def test_a_wish_beyond_the_speeds_is_shortened_and_keeps_its_direction() -> None:
    mapping = linear()
    position, yaw = mapping.displacement_for((20.0, 40.0, 0.0, -9.0), 0.0)
    assert mapping.rate(position, yaw, 0.0) == pytest.approx((2 / 2**0.5, 4 / 2**0.5, 0.0, -0.8))
    assert mapping.displacement_for((0.0, 0.0, 0.0, 0.0), 1.0) == ((0.0, 0.0, 0.0), 0.0)


def test_p_h_is_the_integral_of_its_rate_and_its_yaw_wraps() -> None:
    p_h = (0.0, 0.0, 1.0, 3.0)
    for _ in range(1000):
        p_h = advance(p_h, (1.0, -0.5, 0.0, 0.5), 0.001)
    assert p_h == pytest.approx((1.0, -0.5, 1.0, 3.5 - 2 * pi))


def test_the_leash_pulls_straight_and_says_so() -> None:
    held, pulled = leashed((3.0, 4.0, 0.0, 0.1), (0.0, 0.0, 0.0, 0.0), 2.5, 0.8)
    assert pulled
    assert held == pytest.approx((1.5, 2.0, 0.0, 0.1))
    assert leashed((1.0, 2.0, 0.0, 0.1), (0.0, 0.0, 0.0, 0.0), 2.5, 0.8) == ((1.0, 2.0, 0.0, 0.1), False)


def test_the_yaw_leash_works_across_the_seam() -> None:
    p_h, pulled = leashed((0.0, 0.0, 0.0, -pi + 0.5), (0.0, 0.0, 0.0, pi - 0.5), 1.0, 0.8)
    assert pulled
    assert p_h[3] == pytest.approx(-pi + 0.3)


@given(
    st.tuples(*[st.floats(-1e3, 1e3)] * 3, angles),
    st.tuples(*[st.floats(-1e3, 1e3)] * 3, angles),
    st.floats(0.01, 10),
    st.floats(0.01, 3.1),
)
def test_p_h_is_never_beyond_the_leash(p_h: tuple, p: tuple, leash: float, leash_yaw: float) -> None:
    held, pulled = leashed(p_h, p, leash, leash_yaw)
    assert dist(held[:3], p[:3]) <= leash + 1e-9
    assert abs((held[3] - p[3] + pi) % (2 * pi) - pi) <= leash_yaw + 1e-9
    if not pulled:
        assert held == p_h
