"""Wind, the battery, and the noise of raw sensors."""

import math
import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.battery import Battery
from sim.scenario import Gust, Wind
from sim.sensors import GPS_HORIZONTAL, Sensors
from sim.wind import wind_at

WIND = Wind(mean=(0.6, -0.9, 0.0), gust=(Gust(14.0, 4.0, (0.0, 2.0, 0.3)),))


@pytest.mark.parametrize(
    ("t", "expected"),
    [
        (-1.0, (0.6, -0.9, 0.0)),
        (14.0, (0.6, -0.9, 0.0)),
        (15.0, (0.6, 0.1, 0.15)),
        (16.0, (0.6, 1.1, 0.3)),
        (17.0, (0.6, 0.1, 0.15)),
        (18.0, (0.6, -0.9, 0.0)),
        (99.0, (0.6, -0.9, 0.0)),
    ],
)
def test_a_gust_rises_to_its_peak_and_back(t, expected):
    assert wind_at(WIND, t) == pytest.approx(expected, abs=1e-12)


def test_gusts_add_up():
    wind = Wind(gust=(Gust(0.0, 2.0, (1.0, 0.0, 0.0)), Gust(0.0, 2.0, (0.0, 3.0, 0.0))))
    assert wind_at(wind, 1.0) == pytest.approx((1.0, 3.0, 0.0))


@given(st.floats(-5, 30))
def test_wind_stays_between_calm_and_its_peak_and_does_not_jump(t):
    now, next_ = wind_at(WIND, t), wind_at(WIND, t + 1e-4)
    assert -0.9 - 1e-12 <= now[1] <= 1.1 + 1e-12
    assert math.dist(now, next_) < 1e-3


def test_the_battery_lasts_its_endurance_in_flight_and_longer_on_the_ground():
    battery = Battery(100.0, 6)
    for _ in range(500):
        battery.drain(0.1, flying=True)
    assert battery.remaining == pytest.approx(0.5)
    for _ in range(500):
        battery.drain(0.1, flying=False)
    assert 0.45 < battery.remaining < 0.5
    for _ in range(600):
        battery.drain(0.1, flying=True)
    assert battery.remaining == 0.0


def test_a_cell_sags_under_load_and_as_it_empties():
    battery = Battery(10.0, 4)
    battery.drain(0.0, flying=False)
    assert battery.cell_voltage == pytest.approx(4.05)
    battery.drain(5.0, flying=True)
    assert battery.cell_voltage == pytest.approx(3.6 + 0.225 - 0.1)


def test_noise_is_repeatable_and_differs_by_seed():
    def measured(seed):
        sensors = Sensors(seed)
        return sensors.accelerometer((0.0, 0.0, 9.8)), sensors.gps((1.0, 2.0, 3.0), 0.0)

    assert measured(3) == measured(3)
    assert measured(3) != measured(4)


@pytest.mark.parametrize("dt", [0.2, 5.0])
def test_the_spread_of_gps_does_not_depend_on_how_often_it_is_asked(dt):
    sensors = Sensors(1)
    errors = [sensors.gps((0.0, 0.0, 0.0), number * dt)[0] for number in range(round(30_000 / dt))]
    assert statistics.pstdev(errors) == pytest.approx(GPS_HORIZONTAL, rel=0.15)
