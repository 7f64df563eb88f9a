"""The spectral arc length: the values of shapes that are known, and what it must not depend on."""

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.smoothness import (
    LONGEST_S,
    RATE_HZ,
    Smoothness,
    evenly,
    parted,
    spectral_arc_length,
)


def minimum_jerk(seconds: float) -> np.ndarray:
    """Return the speed of a minimum-jerk movement over 1 m (Flash and Hogan 1985)."""
    s = np.arange(0.0, 1.0, 1.0 / (seconds * RATE_HZ))
    return (30 * s**2 - 60 * s**3 + 30 * s**4) / seconds


def faltering(parts: int, seconds: float = 6.0) -> np.ndarray:
    """Return the speed of a movement made of so many minimum-jerk movements one after the other."""
    return np.concatenate([minimum_jerk(seconds / parts)] * parts)


def test_a_minimum_jerk_movement_has_the_published_value():
    # Balasubramanian et al. 2015 give about −1.4 for the smoothest reaching movement.
    assert spectral_arc_length(minimum_jerk(2.0)) == pytest.approx(-1.41, abs=0.02)


@given(st.floats(1e-3, 1e3))
def test_it_does_not_depend_on_how_fast_a_movement_is(scale):
    speed = faltering(3)
    assert spectral_arc_length(scale * speed) == pytest.approx(spectral_arc_length(speed), rel=1e-9)


@given(st.floats(1.0, 10.0))
def test_it_does_not_depend_on_how_long_a_movement_takes(seconds):
    assert spectral_arc_length(minimum_jerk(seconds)) == pytest.approx(-1.41, abs=0.03)


def test_the_more_a_movement_falters_the_less_smooth_it_is():
    lengths = [spectral_arc_length(faltering(parts)) for parts in (1, 2, 3, 5, 8)]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] < lengths[0] - 1.0


def test_trembling_is_less_smooth():
    steady = minimum_jerk(6.0)
    t = np.arange(len(steady)) / RATE_HZ
    shaky = np.maximum(steady + 0.05 * np.sin(2 * math.pi * 3.0 * t), 0.0)
    assert spectral_arc_length(shaky) < spectral_arc_length(steady) - 0.1


@pytest.mark.parametrize("speed", [[], [0.0, 0.0], [math.nan, 1.0]])
def test_what_did_not_move_or_is_not_known_has_no_smoothness(speed):
    assert math.isnan(spectral_arc_length(np.array(speed)))


@given(st.lists(st.floats(0.0, 100.0), min_size=2, max_size=200))
def test_it_is_never_more_than_minus_one(speed):
    found = spectral_arc_length(np.array(speed))
    assert math.isnan(found) or found <= -1.0 + 1e-9


def rows(seconds: float, start: float = 0.0, every: float = 0.02) -> list[tuple[float, float]]:
    speed = minimum_jerk(seconds)
    t = np.arange(0.0, seconds, every)
    return [(start + float(at), float(np.interp(at, np.arange(len(speed)) / RATE_HZ, speed))) for at in t]


def smoothness(*stretches: list[tuple[float, float]]) -> float:
    """Return the smoothness of stretches with a minute between them."""
    found = Smoothness(gap_s=1.0)
    for number, stretch in enumerate(stretches):
        for t, speed in stretch:
            found.add(60.0 * number + t, speed)
    return found.value()


def test_rows_come_as_they_come():
    # Telemetry at 30 Hz of the same movement tells the same.
    assert smoothness(rows(4.0, every=1 / 30)) == pytest.approx(smoothness(rows(4.0)), abs=0.02)
    assert len(evenly(*zip(*rows(4.0, every=0.1), strict=True))) == pytest.approx(4.0 * RATE_HZ, abs=6)


def wavering(seconds: float) -> list[tuple[float, float]]:
    return [(t, 1.0 + math.sin(9.0 * t)) for t, _ in rows(seconds)]


def test_stretches_count_by_how_long_they_last():
    one, other = rows(4.0), wavering(2.0)
    each = smoothness(one), smoothness(other)
    lasted = one[-1][0], other[-1][0]
    mean = (each[0] * lasted[0] + each[1] * lasted[1]) / sum(lasted)
    assert smoothness(one, other) == pytest.approx(mean)
    assert math.isnan(smoothness(rows(0.5)))
    assert math.isnan(smoothness())


def test_it_is_the_same_whenever_one_looks():
    looked, found = Smoothness(gap_s=1.0), Smoothness(gap_s=1.0)
    for t, speed in (*rows(4.0), *((t + 9.0, speed) for t, speed in wavering(3.0))):
        looked.add(t, speed)
        looked.value()
        found.add(t, speed)
    assert looked.value() == found.value()


def test_a_long_stretch_is_judged_in_parts():
    """An hour coupled takes no longer to judge than a few minutes, and no more memory."""
    part = smoothness(wavering(LONGEST_S))
    found = Smoothness(gap_s=1.0)
    before = after = 0
    tracemalloc.start()
    for row in range(round(6 * LONGEST_S * RATE_HZ)):
        t = row / RATE_HZ
        found.add(t, 1.0 + math.sin(9.0 * t))
        if t == LONGEST_S - 1.0:
            before = tracemalloc.get_traced_memory()[0]
    after = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert found.value() == pytest.approx(part, rel=0.1)
    assert after <= before + 10_000


def test_rows_part_where_time_is_missing():
    one, other = rows(4.0), wavering(2.0)
    apart = parted([*one, *((t + 60.0, v) for t, v in other)], 1.0)
    assert [len(stretch) for stretch in apart] == [len(one), len(other)]
    assert parted([], 1.0) == []
