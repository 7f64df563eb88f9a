"""The rigid body in the whole simulator: it takes off, holds, follows, lands, and bumps into things, as a vehicle."""

import math

import pytest
from sim_flight import Flight

from sim.autopilot.modes import Mode
from sim.scenario import Box, Wind

PRESETS = ("crazyflie", "f450", "hummingbird", "phantom", "x500")


def flight_of(airframe="x500", **scenario):
    return Flight("rigid_body", airframe, **scenario)


@pytest.mark.parametrize("name", PRESETS)
def test_a_flight_from_pad_to_pad(name):
    flight = flight_of(name).take_off(2.0)
    x, y, z, _ = flight.sim.p
    assert math.hypot(x, y) < 0.2
    assert z == pytest.approx(2.0, abs=0.2)
    flight.fly((1.0, 0.0, 0.0), 3.0)
    assert 2.0 < flight.sim.p[0] - x < 3.4
    assert flight.autopilot.set_mode(Mode.LAND).ok
    flight.until(lambda: not flight.autopilot.armed, 20)
    assert flight.sim.p[2] == 0.0
    assert flight.sim.attitude.roll == flight.sim.attitude.pitch == 0.0
    assert not flight.sim.collisions


@pytest.mark.parametrize("name", PRESETS)
def test_it_holds_its_place_in_wind_and_leans_into_it(name):
    wind = 2.0 if name == "crazyflie" else 5.0
    flight = flight_of(name, wind=Wind(mean=(wind, 0.0, 0.0))).take_off(3.0)
    flight.run(15)
    x, y, z, _ = flight.sim.p
    flight.run(5)
    assert math.dist(flight.sim.p[:3], (x, y, z)) < 0.1
    assert math.hypot(x, y) < 1.0
    # Nose east, wind toward east: it leans back, nose up.
    assert flight.sim.attitude.pitch < -0.01


def test_on_the_ground_it_stands_still_in_any_wind():
    flight = flight_of(wind=Wind(mean=(8.0, 0.0, 3.0)))
    flight.run(1)
    assert flight.autopilot.arm().ok
    flight.run(1)
    assert flight.sim.p == (0.0, 0.0, 0.0, 0.0)
    assert flight.sim.attitude.roll == 0.0


def test_a_wall_stops_it_and_it_flies_on_afterwards():
    wall = Box("wall", (4.0, 0.0, 5.0), (0.5, 20.0, 10.0))
    flight = flight_of(obstacle=(wall,)).take_off(3.0).fly((1.5, 0.0, 0.0), 4.0)
    assert flight.sim.p[0] <= 3.75 - flight.sim.airframe.radius + 1e-6
    assert [hit.name for hit in flight.sim.collisions][:1] == ["wall"]
    x = flight.sim.p[0]
    flight.fly((-1.0, 0.5, 0.0), 3.0)
    assert flight.sim.p[0] < x - 1.0
    assert abs(flight.sim.attitude.roll) + abs(flight.sim.attitude.pitch) < 0.3


def test_disarmed_in_the_air_it_falls_and_says_so():
    flight = flight_of().take_off(6.0)
    assert flight.autopilot.disarm(force=True).ok
    flight.until(lambda: flight.sim.grounded, 5)
    assert flight.sim.p[2] == 0.0
    assert flight.sim.collisions


def test_the_same_flight_twice_is_the_same_flight():
    first, second = (flight_of("hummingbird", wind=Wind(mean=(2.0, 1.0, 0.0))).take_off() for _ in range(2))
    assert first.sim.p == second.sim.p
    assert first.sim.v == second.sim.v
