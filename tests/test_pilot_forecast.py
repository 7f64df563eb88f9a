"""The forecast and the compensation, against the simulator's own identified model."""

from math import cos, dist, hypot, pi, sin

import pytest

from groundstation.config import Control
from groundstation.pilot.compensation import Compensation, lagged
from groundstation.pilot.controller import world_rates
from groundstation.pilot.forecast import Forecast, Forecaster, noted
from groundstation.pilot.sight import VehicleSample
from sim.airframe import load_airframe
from sim.models.dynamic import Chi, respond

DT, TELEMETRY = 0.001, 20
AIRFRAME = load_airframe("matrice_100")
CHI = AIRFRAME.chi
CONSTANTS = tuple(getattr(CHI, name) for name in Chi.__struct_fields__)


class Remote:
    """The identified model behind a delay each way, told setpoints at every tick and telling of itself at 50 Hz."""

    def __init__(self, way: float, wind=(0.0, 0.0, 0.0), chi: Chi | None = CHI) -> None:
        self.forecaster, self.forecast = Forecaster(chi), Forecast()
        self.p, self.v = (0.0, 0.0, 2.0, 0.3), (0.0, 0.0, 0.0, 0.0)
        self.ways, self.wind = round(way / DT), wind
        self.setpoints: list = [(0.0, 0.0, 0.0, 0.0)] * self.ways
        self.samples: list = []
        self.truth: list = []
        self.tick = 0
        self.seen, self.came = VehicleSample(self.p), 0

    def step(self, setpoint) -> Forecast:
        """Send a setpoint, and return the forecast of where the vehicle is as it arrives."""
        if self.tick % TELEMETRY == 0:
            self.samples.append(
                (self.tick + self.ways, VehicleSample(self.p, world_rates(self.v, self.p[3])))
            )
        while self.samples and self.samples[0][0] <= self.tick:
            self.came, self.seen = self.samples.pop(0)
        age = (self.tick - self.came) * DT
        delay = 2 * self.ways * DT
        self.forecast = self.forecaster.look(self.forecast, self.seen, age, delay, DT)
        self.forecast = noted(self.forecast, setpoint)
        self.setpoints.append(setpoint)
        self.truth.append((self.p, self.v))
        self.p, self.v = respond(
            self.p, self.v, self.setpoints[self.tick], self.wind, (CONSTANTS, AIRFRAME.air_drag, DT)
        )
        self.tick += 1
        return self.forecast


def apart(a, b) -> float:
    return hypot(*(x - y for x, y in zip(a[:3], b[:3], strict=True)))


def wander(t: float):
    return (1.5 * sin(1.1 * t), 1.0 * cos(0.8 * t), 0.5 * sin(0.5 * t), 0.6 * sin(0.4 * t))


@pytest.mark.parametrize("way", [0.0, 0.05, 0.15, 0.35])
def test_the_forecast_is_where_the_vehicle_will_be_as_the_setpoint_arrives(way: float) -> None:
    remote = Remote(way)
    forecasts = [remote.step(wander(tick * DT)) for tick in range(6000)]
    errors = [apart(forecasts[tick].p, remote.truth[tick + remote.ways][0]) for tick in range(2000, 5600)]
    speeds = [
        dist(
            forecasts[tick].velocity,
            world_rates(remote.truth[tick + remote.ways][1], remote.truth[tick + remote.ways][0][3])[:3],
        )
        for tick in range(2000, 5600)
    ]
    assert max(speeds) < 0.06
    # A mark every 20 ms stands for setpoints that change every tick.
    assert max(errors) < 0.02 + 0.02 * (way > 0.0)


def test_what_the_vehicle_told_is_far_from_where_it_is_by_then() -> None:
    """Without the forecast the same flight would be judged by a place that is off by half a metre."""
    remote = Remote(0.15)
    seen = []
    for tick in range(5000):
        remote.step(wander(tick * DT))
        seen.append(remote.seen.position)
    errors = [apart(seen[tick], remote.truth[tick + 150][0]) for tick in range(2000, 4800)]
    assert max(errors) > 0.4


def test_the_push_of_the_wind_is_learnt_in_its_direction_also_while_turning() -> None:
    wind = (1.0, -0.5, 0.2)
    remote = Remote(0.1, wind)
    pushes = [remote.step(wander(tick * DT)).push for tick in range(6000)]
    expected = tuple(AIRFRAME.air_drag * part for part in wind)
    for push in pushes[3000::7]:
        assert push == pytest.approx(expected, abs=0.08)


def test_a_vehicle_of_unknown_response_is_forecast_well_enough_to_keep_a_margin() -> None:
    remote = Remote(0.1, chi=None)
    forecasts = [remote.step(tuple(0.6 * part for part in wander(tick * DT))) for tick in range(6000)]
    errors = [apart(forecasts[tick].p, remote.truth[tick + 100][0]) for tick in range(2000, 5800)]
    assert max(errors) < 0.12


def test_compensated_the_response_is_the_one_meant_and_bare_it_is_far_off() -> None:
    compensation, k3 = Compensation(CHI, Control().k4), Control().k3

    def worst(*, compensated: bool) -> float:
        p, v, most = (0.0, 0.0, 2.0, 0.0), (0.0, 0.0, 0.0, 0.0), 0.0
        for tick in range(8000):
            t = tick * DT
            meant = (1.2 * sin(t), 0.8 * sin(0.7 * t), 0.3 * sin(0.9 * t), 0.5 * sin(0.6 * t))
            rate = (1.2 * cos(t), 0.56 * cos(0.7 * t), 0.27 * cos(0.9 * t), 0.3 * cos(0.6 * t))
            error = tuple(a - b for a, b in zip(meant, v, strict=True))
            told = compensation.reference(meant, rate, error, v[3], k3) if compensated else meant
            p, v = respond(p, v, told, (0.0, 0.0, 0.0), (CONSTANTS, 0.0, DT))
            if t > 3.0:
                most = max(most, *(abs(a - b) for a, b in zip(meant, v, strict=True)))
        return most

    assert worst(compensated=True) < 0.005
    assert worst(compensated=False) > 0.5


def test_the_pull_on_a_velocity_error_is_bounded() -> None:
    compensation = Compensation(CHI, (2.0, 2.0, 2.0, 2.0))
    still = (0.0, 0.0, 0.0, 0.0)
    told = compensation.reference(still, still, (100.0, -100.0, 100.0, 100.0), 0.0, (2.5,) * 4)
    assert told == pytest.approx((CHI.chi_1 * 2, -CHI.chi_3 * 2, CHI.chi_5 * 2, CHI.chi_9 * 2))


def test_a_lag_stands_for_a_delay_in_the_mean() -> None:
    old = (0.0, 0.0, 0.0, 0.0)
    for tick in range(4000):
        t = tick * DT
        old = lagged(old, (t, -t, 2 * t, 0.0), 0.3, DT)
    assert old == pytest.approx((3.7, -3.7, 7.4, 0.0), abs=0.01)
    assert lagged(old, (1.0, 2.0, 3.0, 4.0), 0.0, DT) == (1.0, 2.0, 3.0, 4.0)


def test_marks_are_forgotten_and_the_forecast_stays_small() -> None:
    remote = Remote(0.1)
    for tick in range(5000):
        remote.step(wander(tick * DT))
    assert 95 <= len(remote.forecast.marks) <= 105
    assert remote.forecast.t == pytest.approx(5.0)
    assert abs(remote.forecast.p[3]) < pi
