"""Wind, the battery, and the noise of raw sensors."""

import itertools
import math
import statistics
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.autopilot.parameters import Parameters
from sim.battery import Battery
from sim.environment.turbulence import low_altitude
from sim.environment.wind import Air, gusty
from sim.scenario import Charge, Gust, Turbulence, Wind
from sim.sensors import BAROMETER_DRIFT, BAROMETER_NOISE, GPS_HORIZONTAL, MAGNETOMETER_NOISE, Sensors

MEAN = (0.6, -0.9, 0.0)
GUSTS = (Gust(14.0, 4.0, (0.0, 2.0, 0.3)),)
HOVER, STILL = (0.0, 0.0, 6.0, 0.0), (0.0, 0.0, 0.0, 0.0)


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
    assert gusty(MEAN, GUSTS, t) == pytest.approx(expected, abs=1e-12)
    air = Air(Wind(MEAN, GUSTS), Parameters(), Random(0))
    assert air.step(HOVER, STILL, t, 0.004) == pytest.approx(expected, abs=1e-12)


def test_gusts_add_up():
    gusts = (Gust(0.0, 2.0, (1.0, 0.0, 0.0)), Gust(0.0, 2.0, (0.0, 3.0, 0.0)))
    assert gusty((0.0, 0.0, 0.0), gusts, 1.0) == pytest.approx((1.0, 3.0, 0.0))


@given(st.floats(-5, 30))
def test_wind_stays_between_calm_and_its_peak_and_does_not_jump(t):
    now, next_ = gusty(MEAN, GUSTS, t), gusty(MEAN, GUSTS, t + 1e-4)
    assert -0.9 - 1e-12 <= now[1] <= 1.1 + 1e-12
    assert math.dist(now, next_) < 1e-3


def blown(wind, dt, seconds=1000.0, seed=2, parameters=None):
    air = Air(wind, parameters or Parameters(), Random(seed))
    return [air.step(HOVER, STILL, 0.0, dt) for _ in range(round(seconds / dt))]


@pytest.mark.parametrize("dt", [0.004, 0.02, 0.2])
def test_the_spread_at_hover_does_not_depend_on_the_step(dt):
    """A turbulent wind from the south: its own axes are north, west, up."""
    wind = Wind((0.0, 12.0, 0.0), turbulence=Turbulence(intensity=1.2))
    east, north, up = zip(*blown(wind, dt), strict=True)
    level = 1.2 * low_altitude(6.0)[2]
    assert statistics.fmean(north) == pytest.approx(12.0, abs=0.6)
    assert statistics.pstdev(east) == pytest.approx(level, rel=0.15)
    assert statistics.pstdev(north) == pytest.approx(level, rel=0.15)
    assert statistics.pstdev(up) == pytest.approx(1.2, rel=0.15)


def test_the_same_seed_blows_the_same():
    wind = Wind(MEAN, turbulence=Turbulence("von_karman", 1.0))
    assert blown(wind, 0.004, 5.0) == blown(wind, 0.004, 5.0)
    assert blown(wind, 0.004, 5.0) != blown(wind, 0.004, 5.0, seed=3)


def test_the_missions_wind_is_in_the_parameters_and_they_change_it():
    parameters = Parameters()
    air = Air(Wind(MEAN, turbulence=Turbulence(intensity=0.5)), parameters, Random(0))
    assert [parameters[f"SIM_WIND_{axis}"] for axis in "ENU"] == list(MEAN)
    assert parameters["SIM_WIND_TURB"] == 0.5
    parameters.set("SIM_WIND_TURB", 0.0)
    assert air.step(HOVER, STILL, 0.0, 0.004) == MEAN
    parameters.set("SIM_WIND_U", -1.5)
    assert air.step(HOVER, STILL, 0.0, 0.004) == (0.6, -0.9, -1.5)
    parameters.set("SIM_WIND_TURB", 2.0)
    heights = [air.step(HOVER, STILL, 0.0, 0.02)[2] for _ in range(5000)]
    assert statistics.pstdev(heights) > 1.0


def test_the_battery_lasts_its_endurance_at_hover_and_longer_on_the_ground():
    battery = Battery(100.0, 6, Charge())
    for _ in range(500):
        battery.drain(1.0, 0.1)
    assert battery.remaining == pytest.approx(0.5)
    for _ in range(500):
        battery.drain(0.0, 0.1)
    assert battery.remaining == pytest.approx(0.475)
    for _ in range(600):
        battery.drain(1.0, 0.1)
    assert battery.remaining == 0.0


def test_more_thrust_takes_more_power_by_momentum_theory():
    hovering, climbing, charged = (Battery(100.0, 4, Charge()) for _ in range(3))
    hovering.drain(1.0, 10.0)
    climbing.drain(1.21, 10.0)
    charged.drain(50.0, 10.0)
    assert 1.0 - climbing.remaining == pytest.approx(1.331 * (1.0 - hovering.remaining))
    assert 1.0 - charged.remaining == pytest.approx(2.0**1.5 * (1.0 - hovering.remaining))


def test_a_mission_may_begin_with_a_part_of_it_and_drain_faster():
    battery = Battery(100.0, 4, Charge(remaining=0.35, drain=3.0))
    assert battery.remaining == 0.35
    battery.drain(1.0, 5.0)
    assert battery.remaining == pytest.approx(0.2)


def test_a_cell_sags_under_load_and_as_it_empties():
    battery = Battery(10.0, 4, Charge())
    battery.drain(0.0, 0.0)
    assert battery.cell_voltage == pytest.approx(4.05)
    battery.drain(1.0, 5.0)
    assert battery.cell_voltage == pytest.approx(3.6 + 0.225 - 0.1)


def test_a_failed_battery_tells_that_it_is_nearly_empty_until_it_is_mended():
    battery = Battery(100.0, 4, Charge())
    battery.failed = True
    assert 0.0 < battery.remaining < 0.05
    battery.failed = False
    assert battery.remaining == 1.0


def test_noise_is_repeatable_and_differs_by_seed():
    def measured(seed):
        sensors = Sensors(seed)
        return (
            sensors.accelerometer((0.0, 0.0, 9.8)),
            sensors.gps((1.0, 2.0, 3.0), 0.0),
            sensors.barometer(2.0, 0.0),
            sensors.magnetometer((0.2, 0.0, 0.4)),
        )

    assert measured(3) == measured(3)
    assert measured(3) != measured(4)


@pytest.mark.parametrize("dt", [0.2, 5.0])
def test_the_spread_of_gps_does_not_depend_on_how_often_it_is_asked(dt):
    sensors = Sensors(1)
    errors = [sensors.gps((0.0, 0.0, 0.0), number * dt)[0] for number in range(round(30_000 / dt))]
    assert statistics.pstdev(errors) == pytest.approx(GPS_HORIZONTAL, rel=0.15)


def test_a_barometer_drifts_slowly_and_trembles():
    sensors = Sensors(4)
    heights = [sensors.barometer(5.0, number * 0.05) for number in range(400_000)]
    trembling = [b - a for a, b in itertools.pairwise(heights)]
    assert statistics.pstdev(trembling) == pytest.approx(math.sqrt(2) * BAROMETER_NOISE, rel=0.05)
    assert statistics.pstdev(heights) == pytest.approx(math.hypot(BAROMETER_DRIFT, BAROMETER_NOISE), rel=0.3)


def test_a_magnetometer_trembles():
    sensors = Sensors(4)
    fields = [sensors.magnetometer((0.2, -0.1, 0.4)) for _ in range(5000)]
    for axis, truth in zip(zip(*fields, strict=True), (0.2, -0.1, 0.4), strict=True):
        assert statistics.fmean(axis) == pytest.approx(truth, abs=3e-4)
        assert statistics.pstdev(axis) == pytest.approx(MAGNETOMETER_NOISE, rel=0.1)
