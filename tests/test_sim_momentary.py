"""What is let happen to a simulated vehicle once, by parameters that go back to 0 by themselves."""

import math

import pytest

from sim.autopilot.modes import Mode
from tests.sim_flight import DT, Flight

PEAK = (5.0, -2.0, 1.0)


def value(flight, name):
    return flight.autopilot.parameters[name]


def gust(flight, seconds):
    return flight.set(
        "SIM_GUST_E", PEAK[0], "SIM_GUST_N", PEAK[1], "SIM_GUST_U", PEAK[2], "SIM_GUST_S", seconds
    )


def test_one_gust_blows_from_now_on_and_is_over_by_itself():
    flight = Flight().take_off()
    gust(flight, 4.0).run(2.0)
    assert flight.sim.wind == pytest.approx(PEAK, rel=0.01)
    assert value(flight, "SIM_GUST_S") == 4.0
    flight.run(2.0 + 2 * DT)
    assert math.hypot(*flight.sim.wind) < 0.01
    assert value(flight, "SIM_GUST_S") == 0.0
    flight.run(4.0)
    assert flight.sim.wind == (0.0, 0.0, 0.0)
    gust(flight, 2.0).run(1.0)
    assert flight.sim.wind == pytest.approx(PEAK, rel=0.01), "another can follow"


def test_a_gust_told_twice_on_a_bad_link_blows_once():
    flight = Flight().take_off()
    gust(flight, 4.0).run(1.0)
    gust(flight, 4.0).run(1.0)
    assert flight.sim.wind == pytest.approx(PEAK, rel=0.01)


def test_with_0_in_between_it_is_another_gust_and_they_add_up():
    flight = Flight().take_off()
    gust(flight, 4.0).run(2.0)
    flight.set("SIM_GUST_S", 0.0).run(DT)
    gust(flight, 4.0).run(1.0)
    assert flight.sim.wind == pytest.approx(PEAK, rel=0.02), "half of each"
    flight.run(1.0)
    assert flight.sim.wind == pytest.approx(PEAK, rel=0.02), "the first is over"


@pytest.mark.parametrize(
    ("left", "action", "words", "mode"),
    [
        (0.12, 3, "Low battery", Mode.HOLD),
        (0.06, 0, "Critical battery", Mode.HOLD),
        (0.06, 2, "Critical battery level", Mode.LAND),
        (0.06, 3, "Critical battery level", Mode.RETURN),
        (0.04, 3, "Emergency battery level", Mode.LAND),
    ],
)
def test_a_charge_that_is_set_has_px4s_consequences(left, action, words, mode):
    flight = Flight().set("COM_LOW_BAT_ACT", action).take_off()
    flight.set("SIM_BAT_LEFT", left).run(1.0)
    assert flight.sim.battery.remaining == pytest.approx(left, abs=0.002)
    assert any(text.startswith(words) for text in flight.texts), flight.texts
    flight.run(8.0)
    assert flight.mode is mode
    assert value(flight, "SIM_BAT_LEFT") == 0.0
    assert flight.sim.battery.remaining < left, "it drains on from there"


def test_a_charge_can_be_given_back():
    flight = Flight().take_off()
    flight.set("SIM_BAT_LEFT", 0.1).run(1.0)
    flight.set("SIM_BAT_LEFT", 0.9).run(1.0)
    assert flight.sim.battery.remaining == pytest.approx(0.9, abs=0.002)


def test_gps_is_lost_for_so_long_and_comes_back():
    flight = Flight().take_off()
    flight.set("SIM_GPS_LOST", 3.0).run(2.0)
    assert "gps" in flight.sim.failed
    flight.run(1.1)
    assert "gps" not in flight.sim.failed
    assert value(flight, "SIM_GPS_LOST") == 0.0


def test_gps_lost_may_be_given_back_before_its_time():
    flight = Flight().take_off()
    flight.set("SIM_GPS_LOST", 30.0).run(1.0)
    flight.set("SIM_GPS_LOST", 0.0).run(0.1)
    assert "gps" not in flight.sim.failed
    flight.sim.inject("gps", failed=True)
    flight.run(40.0)
    assert "gps" in flight.sim.failed, "what was broken otherwise stays so"
