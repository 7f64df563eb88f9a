from itertools import pairwise
from math import inf, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.frames import wrap
from groundstation.pilot.sight import FORESIGHT_S, Sight, VehicleSample, carried_on, look

DT = 0.001


def watch(samples: dict[int, VehicleSample], ticks: int) -> list[tuple]:
    """Return the position seen at every tick; samples arrive at the ticks given."""
    sight, seen, newest, came = Sight(), [], VehicleSample(), 0
    for tick in range(ticks):
        if tick in samples:
            newest, came = samples[tick], tick
        sight, position = look(sight, newest, (tick - came) * DT, DT)
        seen.append(position)
    return seen


def test_a_sample_is_carried_on_with_its_velocity_but_not_for_long() -> None:
    sample = VehicleSample((1.0, 2.0, 3.0, 0.5), (1.0, -2.0, 0.5, 0.1))
    assert carried_on(sample, 0.02) == pytest.approx((1.02, 1.96, 3.01, 0.502))
    assert carried_on(sample, 9.0) == carried_on(sample, FORESIGHT_S)
    assert carried_on(sample, -1.0) == sample.position


def test_at_a_steady_velocity_it_is_exact() -> None:
    samples = {
        tick: VehicleSample((1.5 * tick * DT, 0.0, 2.0, wrap(0.5 * tick * DT)), (1.5, 0.0, 0.0, 0.5))
        for tick in range(0, 1000, 20)
    }
    for tick, position in enumerate(watch(samples, 1000)):
        assert position == pytest.approx((1.5 * tick * DT, 0.0, 2.0, 0.5 * tick * DT), abs=1e-9)


def test_the_first_sample_is_taken_as_it_is() -> None:
    assert watch({0: VehicleSample((5.0, 6.0, 7.0, 1.0))}, 1) == [(5.0, 6.0, 7.0, 1.0)]


def test_the_first_sample_is_taken_as_it_is_after_any_time_without_one() -> None:
    sight, _ = look(Sight(), VehicleSample(), inf, DT)
    _, position = look(sight, VehicleSample((5.0, 6.0, 7.0, 1.0)), 0.0, DT)
    assert position == (5.0, 6.0, 7.0, 1.0)


def test_a_sample_that_disagrees_is_faded_in_over_50_ms() -> None:
    seen = watch({0: VehicleSample(), 10: VehicleSample((1.0, 0.0, 0.0, 0.0))}, 400)
    assert seen[9][0] == 0.0
    assert seen[10][0] == pytest.approx(0.0198, abs=1e-4)
    assert seen[59][0] == pytest.approx(1 - 0.3679, abs=1e-3)
    assert seen[-1][0] == pytest.approx(1.0, abs=1e-3)


def test_it_goes_the_short_way_across_the_seam_of_the_yaw() -> None:
    east, west = VehicleSample((0.0, 0.0, 0.0, pi - 0.1)), VehicleSample((0.0, 0.0, 0.0, -pi + 0.1))
    yaws = [position[3] for position in watch({0: east, 10: west}, 300)]
    assert all(abs(wrap(yaw - pi)) < 0.1 + 1e-9 for yaw in yaws)
    assert wrap(yaws[-1] - (-pi + 0.1)) == pytest.approx(0.0, abs=1e-3)


@given(st.integers(5, 50), st.integers(0, 4), st.randoms(use_true_random=False))
def test_late_and_early_samples_of_a_swinging_drone_make_no_steps(every: int, jitter: int, random) -> None:
    samples = {}
    for tick in range(0, 1500, every):
        t = tick * DT
        samples[tick + random.randint(0, jitter)] = VehicleSample(
            (0.5 * sin(pi * t), 0.0, 0.0, 0.0), (0.5 * pi * sin(pi * t + pi / 2), 0.0, 0.0, 0.0)
        )
    xs = [position[0] for position in watch(samples, 1500)][60:]
    speeds = [(after - before) / DT for before, after in pairwise(xs)]
    # The drone's own 1.6 m/s, and 1/50 ms of what a sample can be off by.
    off = 0.5 * 4.94 * (every * DT) ** 2 + 1.6 * 2 * jitter * DT
    assert max(map(abs, speeds)) < 1.6 + 2 * off / 0.05 + 0.1
