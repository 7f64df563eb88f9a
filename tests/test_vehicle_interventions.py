"""Which of a simulated vehicle's parameters make something happen, and that all of them are the simulator's own."""

import pytest

from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)
from groundstation.training.happening import Calm
from groundstation.vehicle.interventions import writes_for
from sim.autopilot.parameters import SPECS

AIR = (3.0, -2.0, 0.5)


@pytest.mark.parametrize(
    ("happening", "writes"),
    [
        (
            WindChange(velocity=AIR, turbulence=1.0),
            {"SIM_WIND_E": 3.0, "SIM_WIND_N": -2.0, "SIM_WIND_U": 0.5, "SIM_WIND_TURB": 1.0},
        ),
        (
            GustNow(velocity=AIR, duration_s=4.0),
            {"SIM_GUST_E": 3.0, "SIM_GUST_N": -2.0, "SIM_GUST_U": 0.5, "SIM_GUST_S": 4.0},
        ),
        (
            Delay(round_trip_s=0.3, jitter_s=0.02),
            {"SIM_UP_DELAY": 0.15, "SIM_DN_DELAY": 0.15, "SIM_UP_JITTER": 0.02, "SIM_DN_JITTER": 0.02},
        ),
        (Loss(share=0.1), {"SIM_UP_LOSS": 0.1, "SIM_DN_LOSS": 0.1}),
        (LinkLoss(duration_s=5.0), {"SIM_NET_BLACK": 5.0}),
        (BatteryLeft(remaining=0.1), {"SIM_BAT_LEFT": 0.1}),
        (GpsLoss(duration_s=6.0), {"SIM_GPS_LOST": 6.0}),
        (DeviceLoss(duration_s=6.0), {}),
        (Calm(), {}),
    ],
)
def test_writes(happening, writes):
    found = writes_for(happening)
    assert dict(found) == writes
    assert all(name.startswith("SIM_") and SPECS[name].allows(value) for name, value in found)


@pytest.mark.parametrize(
    ("happening", "name", "value"),
    [
        (GustNow(velocity=AIR, duration_s=4.0), "SIM_GUST_S", 4.0),
        (GpsLoss(duration_s=6.0), "SIM_GPS_LOST", 6.0),
        (BatteryLeft(remaining=0.1), "SIM_BAT_LEFT", 0.1),
    ],
)
def test_the_same_again_is_another_one(happening, name, value):
    writes = writes_for(happening)
    assert (writes[0], writes[-1]) == ((name, 0.0), (name, value))
    assert [each for each, _ in writes].count(name) == 2
