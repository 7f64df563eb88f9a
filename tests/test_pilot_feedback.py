from math import hypot, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.pilot.feedback import hand_force, position_force

vectors = st.tuples(*[st.floats(-100, 100)] * 3)


def test_equation_5_worked_by_hand() -> None:
    # p̃ = (0.5, −0.25, 1), K = diag(4, 2, 3): f = (−2, 0.5, −3); yaw has no part in it.
    assert position_force((0.5, -0.25, 1.0, 2.0), (4.0, 2.0, 3.0)) == (-2.0, 0.5, -3.0)


def test_a_blocked_drone_pushes_the_hand_back() -> None:
    force = position_force((1.0, 0.0, 0.0, 0.0), (4.0, 4.0, 4.0))
    assert force[0] < 0.0


def test_in_the_heading_frame_the_force_is_turned_to_the_hand() -> None:
    # A drone that looks north and lags behind to the south: the hand is pushed back along its own x.
    force = hand_force((0.0, -3.0, 1.0), pi / 2, (0.0, 0.0, 0.0), 2.0, 10.0)
    assert force == pytest.approx((-3.0, 0.0, 1.0))


def test_damping_works_against_the_handle() -> None:
    assert hand_force((1.0, 0.0, 0.0), 0.0, (0.1, -0.2, 0.3), 2.0, 10.0) == pytest.approx((0.8, 0.4, -0.6))


@given(vectors, st.floats(-7, 7), vectors, st.floats(0, 50), st.floats(0.01, 20))
def test_no_force_is_stronger_than_the_device_and_a_clipped_one_keeps_its_direction(
    force: tuple, turn: float, velocity: tuple, damping: float, limit: float
) -> None:
    free = hand_force(force, turn, velocity, damping, 1e9)
    clipped = hand_force(force, turn, velocity, damping, limit)
    assert hypot(*clipped) <= limit * (1 + 1e-12)
    share = min(1.0, limit / hypot(*free)) if any(free) else 1.0
    assert clipped == pytest.approx(tuple(share * part for part in free), abs=1e-9)
