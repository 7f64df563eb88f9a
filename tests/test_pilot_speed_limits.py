"""The pilot asks for no speed that the vehicle does not allow, whatever the settings say."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, inf, nan
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from servo_bench import Bench

from groundstation.config import Limits, Mapping, Settings
from groundstation.messages import FlightMode, Phase, Severity, Stream
from groundstation.pilot.limits import bounded

LIMITS = Limits(horizontal_speed=5.0, vertical_speed=3.0)
SETTINGS = Settings(limits=LIMITS, mapping=Mapping(speed=(5.0, 5.0, 3.0, 0.8)))


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path, settings=SETTINGS)
    yield bench
    bench.close()


def fastest(bench: Bench, stick: tuple[float, float, float]) -> tuple[float, float]:
    """Hold the stick for a while; return the fastest that was asked for, around and up or down, m/s."""
    list(bench.world.setpoints.drain())
    bench.stick = stick
    bench.run(4.0)
    asked = [setpoint.velocity for setpoint in bench.world.setpoints.drain()]
    return max(hypot(v[0], v[1]) for v in asked), max(abs(v[2]) for v in asked)


@given(st.tuples(*[st.floats(allow_nan=True, allow_infinity=True)] * 3))
def test_the_smaller_of_both_counts_and_what_is_not_known_bounds_nothing(
    vehicle: tuple[float, float, float],
) -> None:
    used = bounded(LIMITS, vehicle)
    assert 0.0 < used.horizontal_speed <= LIMITS.horizontal_speed
    assert 0.0 < used.vertical_speed <= LIMITS.vertical_speed
    around, up, down = vehicle
    assert not 0.0 < around < used.horizontal_speed
    assert not 0.0 < up < used.vertical_speed
    assert not 0.0 < down < used.vertical_speed
    if not any(0.0 < limit < 5.0 for limit in vehicle):
        assert used is LIMITS


def test_a_slow_vehicle_is_flown_slowly(bench: Bench) -> None:
    bench.world.status.speed_limits[:] = (1.0, 3.0, 0.5)
    bench.engage()
    around, up = fastest(bench, (0.07, 0.0, 0.07))
    assert around == pytest.approx(1.0, abs=0.02)
    assert up == pytest.approx(0.5, abs=0.02)
    assert around <= 1.0 + 1e-9
    assert up <= 0.5 + 1e-9


def test_a_fast_vehicle_is_flown_as_the_settings_have_it(bench: Bench) -> None:
    bench.world.status.speed_limits[:] = (12.0, 4.0, 4.0)
    bench.engage()
    around, up = fastest(bench, (0.0, 0.1, 0.0))
    assert around == pytest.approx(5.0, abs=0.1)
    assert up < 0.1


def test_what_it_is_flown_with_is_told_once(bench: Bench) -> None:
    bench.world.status.speed_limits[:] = (1.0, 3.0, 0.5)
    bench.run(0.5)
    words = "Speed limits with this vehicle: 1 m/s around, 0.5 m/s up and down."
    assert bench.said().count((Severity.INFO, words)) == 1


def test_limits_that_change_in_flight_let_go_of_the_hand(bench: Bench) -> None:
    bench.world.status.speed_limits[:] = (12.0, 4.0, 4.0)
    bench.engage()
    bench.stick = (0.1, 0.0, 0.0)
    bench.run(1.0)
    bench.world.status.speed_limits[:] = (1.0, 4.0, 4.0)
    bench.run(0.05)
    assert bench.phase() is Phase.DISENGAGED
    assert (Severity.ALARM, "Disengaged: the vehicle's speed limits have changed.") in bench.said()
    bench.stick = (0.0, 0.0, 0.0)
    bench.world.confirm(FlightMode.HOLD, Stream.IDLE)
    bench.engage()
    assert fastest(bench, (0.1, 0.0, 0.0))[0] <= 1.0 + 1e-9


@pytest.mark.parametrize("nonsense", [nan, inf, -1.0, 0.0])
def test_limits_that_cannot_be_change_nothing(bench: Bench, nonsense: float) -> None:
    bench.engage()
    bench.world.status.speed_limits[:] = (nonsense,) * 3
    bench.run(0.2)
    assert bench.phase() is Phase.ENGAGED
