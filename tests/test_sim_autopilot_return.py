"""Return: the height of the way, where it ends, and what each parameter does to it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sim_flight import Flight

from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Action, Leg
from sim.autopilot.returning import return_height


def away_at(x, y, z=3.0, model="kinematic", **values):
    """Fly somewhere."""
    flight = Flight(model)
    for name, value in values.items():
        flight.set(name, value)
    flight.take_off(3.0)
    flight.autopilot.reposition((x, y, z), None)
    flight.until(lambda: math.dist(flight.sim.p[:3], (x, y, z)) < 0.3, 60)
    return flight


def come_back(flight, at_most=150):
    """Return to the ground; give the highest point, and the heights while sinking near the end."""
    heights = []
    assert flight.autopilot.set_mode(Mode.RETURN).ok
    flight.until(lambda: not flight.autopilot.armed, at_most, lambda: heights.append(flight.sim.p[2]))
    return max(heights)


@pytest.mark.parametrize("model", ["kinematic", "dynamic"])
def test_far_away_it_climbs_to_the_return_height_comes_home_and_lands(model):
    flight = away_at(25.0, 0.0, model=model, RTL_RETURN_ALT=12.0)
    assert come_back(flight) == pytest.approx(12.0, abs=0.4)
    assert math.hypot(*flight.sim.p[:2]) < 0.5
    assert flight.sim.p[2] == 0.0
    assert flight.sim.p[3] == pytest.approx(0.0, abs=0.1)
    assert not flight.sim.collisions


def test_higher_than_that_it_stays_as_high():
    assert come_back(away_at(20.0, 0.0, 15.0, RTL_RETURN_ALT=8.0)) == pytest.approx(15.0, abs=0.4)


@given(st.floats(0, 200), st.floats(0, 100), st.floats(0.5, 50), st.sampled_from((0, 25, 45, 65, 80, 90)))
def test_the_height_of_the_way(away, height, near, angle):
    parameters = Parameters()
    for name, value in (("RTL_RETURN_ALT", height), ("RTL_MIN_DIST", near), ("RTL_CONE_ANG", angle)):
        assert parameters.set(name, value)
    over = return_height(parameters, away)
    if away <= 2.0:
        assert over == 2.0 * away
    else:
        assert over >= 4.0
        assert over <= max(height, 4.0)
        if away > near or angle == 0:
            assert over == max(height, 4.0)


def test_the_cone():
    parameters = Parameters()
    assert return_height(parameters, 8.0) == pytest.approx(8.0)
    assert return_height(parameters, 10.1) == 30.0
    parameters.set("RTL_CONE_ANG", 25)
    assert return_height(parameters, 8.0) == pytest.approx(8.0 / math.tan(math.radians(25.0)))


def test_it_waits_at_the_lower_height_before_landing():
    flight = away_at(15.0, 0.0, RTL_RETURN_ALT=10.0, RTL_DESCEND_ALT=5.0, RTL_LAND_DELAY=6.0)
    flight.autopilot.set_mode(Mode.RETURN)
    flight.until(lambda: flight.sim.p[0] < 0.6 and flight.sim.p[2] < 5.4, 60)
    flight.run(5)
    assert flight.sim.p[2] == pytest.approx(5.0, abs=0.2)
    flight.run(3)
    assert flight.sim.p[2] < 4.6


def test_it_may_stay_in_the_air():
    flight = away_at(15.0, 0.0, RTL_RETURN_ALT=6.0, RTL_DESCEND_ALT=5.0, RTL_LAND_DELAY=-1.0)
    flight.autopilot.set_mode(Mode.RETURN)
    flight.run(60)
    assert flight.sim.p[:3] == pytest.approx((0.0, 0.0, 5.0), abs=0.1)
    assert flight.mode is Mode.RETURN


LANDING = Leg(Action.LAND, (0.0, 20.0, 0.0))


@pytest.mark.parametrize(
    ("kind", "rally", "end"),
    [
        (0, (), (0.0, 0.0)),
        (0, ((20.0, 0.0, 0.0),), (20.0, 0.0)),
        (0, ((40.0, 40.0, 0.0),), (0.0, 0.0)),
        (1, (), (0.0, 20.0)),
        (1, ((9.0, 0.0, 0.0),), (9.0, 0.0)),
        (3, ((40.0, 40.0, 0.0),), (0.0, 0.0)),
        (3, ((12.0, 0.0, 0.0),), (12.0, 0.0)),
    ],
)
def test_it_ends_at_the_nearest_of_the_places_there_are(kind, rally, end):
    flight = away_at(12.0, 2.0, RTL_TYPE=kind, RTL_RETURN_ALT=5.0)
    assert flight.autopilot.load_mission((Leg(Action.WAYPOINT, (5.0, 5.0, 5.0)), LANDING)).ok
    assert flight.autopilot.load_rally(rally).ok
    come_back(flight)
    assert flight.sim.p[:2] == pytest.approx(end, abs=0.6)


def test_a_set_home_is_returned_to():
    flight = away_at(12.0, 0.0, RTL_RETURN_ALT=5.0)
    flight.autopilot.set_home((12.0, 9.0, 0.0, 1.0))
    come_back(flight)
    assert flight.sim.p[:2] == pytest.approx((12.0, 9.0), abs=0.6)
    assert flight.sim.p[3] == pytest.approx(1.0, abs=0.1)


def test_an_operator_may_break_it_off():
    flight = away_at(25.0, 0.0)
    flight.autopilot.set_mode(Mode.RETURN)
    flight.run(3)
    assert flight.autopilot.set_mode(Mode.HOLD).ok
    flight.run(5)
    before = flight.sim.p
    flight.run(3)
    assert math.dist(before, flight.sim.p) < 0.05
