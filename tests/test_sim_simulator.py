"""The simulator as a whole: what it hits, what it believes, what it starts with, and that a seed is a flight."""

import math

import pytest

from sim.autopilot.modes import Mode
from sim.scenario import (
    STAND_ALONE,
    Box,
    Charge,
    Contact,
    Cylinder,
    EstimateChoice,
    Gate,
    Scenario,
    ScenarioError,
    Sphere,
    Turbulence,
    VehicleChoice,
    Wall,
    Wind,
)
from sim.simulator import build

DT = 0.004
AHEAD = {
    "box": Box("thing", (6.0, 0.0, 2.0), (1.0, 4.0, 4.0)),
    "cylinder": Cylinder("thing", (6.0, 0.0, 2.0), 1.0, 4.0),
    "sphere": Sphere("thing", (6.0, 0.0, 2.0), 1.5),
    "wall": Wall("thing", (6.0, -4.0), (6.0, 4.0), 4.0, 0.02),
    "gate": Gate("thing", (6.0, 1.0, 2.0), 1.9, 2.0, frame=0.05),
}
NEAR = Box("near", (1.6, 0.0, 2.0), (1.0, 4.0, 4.0))


class Drone:
    """A simulator, made to move by its own state where no autopilot would do so."""

    def __init__(self, scenario=None, **choices):
        self.sim = build(scenario or Scenario(), **choices)
        self.mailbox = self.sim.autopilot.mailbox()

    def run(self, seconds):
        for _ in range(round(seconds / DT)):
            self.sim.step(DT)
        return self

    def take_off(self, height=2.0):
        assert self.sim.autopilot.arm().ok
        assert self.sim.autopilot.take_off(height).ok
        return self.run(8)

    def throw(self, speed):
        """Give it a velocity forward."""
        self.sim.v = (speed, 0.0, 0.0, 0.0)
        return self

    def texts(self):
        return [notice.text for notice in self.mailbox]

    def path(self, seconds):
        points = []
        for _ in range(round(seconds / DT)):
            self.sim.step(DT)
            points.append((self.sim.p, self.sim.v, self.sim.estimate))
        return points


@pytest.mark.parametrize("kind", AHEAD)
def test_every_kind_of_obstacle_stops_it(kind):
    drone = Drone(Scenario(obstacle=(AHEAD[kind],))).take_off()
    assert drone.sim.autopilot.parameters.set("MPC_XY_CRUISE", 1.5)
    assert drone.sim.autopilot.reposition((12.0, 0.0, 2.0), None).ok
    nearest = min(drone.sim.world.clearance(p[:3])[0] for p, _, _ in drone.path(12))
    assert nearest == pytest.approx(drone.sim.airframe.radius, abs=2e-3)
    assert {collision.name for collision in drone.sim.collisions} == {"thing"}
    assert drone.sim.p[0] < 6.0
    assert "Collision with thing" in drone.texts()


@pytest.mark.parametrize("kind", AHEAD)
def test_at_50_metres_a_second_it_does_not_pass_and_the_motors_stop(kind):
    drone = Drone(Scenario(obstacle=(AHEAD[kind],))).take_off().throw(50.0).run(0.3)
    collision = drone.sim.collisions[0]
    assert collision.name == "thing"
    assert collision.speed > 20.0
    assert not drone.sim.autopilot.armed
    assert any(text.startswith("Crashed into thing") for text in drone.texts())
    drone.run(5)
    assert drone.sim.p[0] < 6.0
    assert drone.sim.grounded


def test_it_flies_on_through_a_gate():
    gate = Gate("gate", (4.0, 0.0, 2.0), 1.6, 1.6)
    drone = Drone(Scenario(obstacle=(gate,))).take_off()
    assert drone.sim.autopilot.reposition((8.0, 0.0, 2.0), None).ok
    drone.run(12)
    assert drone.sim.p[:3] == pytest.approx((8.0, 0.0, 2.0), abs=0.1)
    assert not drone.sim.collisions


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_it_bounces_as_the_mission_says(restitution):
    contact = Contact(restitution=restitution, crash_speed=100.0)
    drone = Drone(Scenario(obstacle=(NEAR,), contact=contact)).take_off().throw(8.0)
    while not drone.sim.collisions:
        drone.run(DT)
    assert drone.sim.collisions[0].speed > 5.0
    assert drone.sim.v[0] == pytest.approx(-restitution * drone.sim.collisions[0].speed, abs=1e-9)


def test_a_knock_is_no_crash():
    drone = Drone(Scenario(obstacle=(NEAR,))).take_off().throw(2.5).run(3)
    assert 1.0 < drone.sim.collisions[0].speed < 2.5
    assert drone.sim.autopilot.armed


def test_a_hard_landing_is_a_crash():
    drone = Drone().take_off(3.0)
    drone.sim.v = (0.0, 0.0, -30.0, 0.0)
    drone.run(4)
    (collision,) = drone.sim.collisions
    assert collision.name == "floor"
    assert collision.speed > 3.0
    assert not drone.sim.autopilot.armed


def test_the_same_seed_is_the_same_flight_and_another_is_not():
    scenario = Scenario(
        wind=Wind((1.0, 0.5, 0.0), turbulence=Turbulence("von_karman", 0.8)), estimate=EstimateChoice("gps")
    )
    first, again, other = (Drone(scenario, seed=seed).take_off().path(5) for seed in (7, 7, 8))
    assert first == again
    assert first != other


@pytest.mark.parametrize("quality", ["rtk", "gps"])
def test_it_flies_by_what_it_believes(quality):
    """The estimate stays where it was told to; the truth wanders."""
    drone = Drone(Scenario(estimate=EstimateChoice(quality)), seed=3).take_off()
    flown = drone.path(60)[-5000:]
    believed = max(math.dist(estimate.p[:3], (0.0, 0.0, 2.0)) for _, _, estimate in flown)
    true = max(math.dist(p[:3], (0.0, 0.0, 2.0)) for p, _, _ in flown)
    assert believed < 0.06
    assert (0.01 if quality == "rtk" else 0.1) < true < (0.15 if quality == "rtk" else 2.0)


def test_the_stand_alone_vehicle_lands_though_it_does_not_know_its_height_to_the_centimetre():
    drone = Drone(STAND_ALONE, seed=11).take_off()
    assert drone.sim.estimate.p != drone.sim.p
    assert drone.sim.autopilot.set_mode(Mode.LAND).ok
    drone.run(15)
    assert not drone.sim.autopilot.armed
    assert drone.sim.p[2] == 0.0
    assert not drone.sim.collisions


def test_without_gps_it_drifts_and_says_that_its_position_is_not_valid():
    drone = Drone(seed=2).take_off()
    assert drone.sim.estimate.p == drone.sim.p
    drone.sim.inject("gps", True)
    assert drone.sim.failed == {"gps"}
    drone.run(10)
    assert not drone.sim.estimate.valid_position
    assert math.dist(drone.sim.p[:2], drone.sim.estimate.p[:2]) > 0.3
    drone.sim.inject("gps", False)
    drone.run(DT)
    assert drone.sim.failed == set()
    assert drone.sim.estimate.valid_position
    assert drone.sim.estimate.p == drone.sim.p


def test_a_battery_may_begin_partly_empty_drain_fast_and_fail():
    drone = Drone(Scenario(battery=Charge(remaining=0.35, drain=20.0))).take_off()
    left = drone.sim.battery.remaining
    assert left < 0.35
    drone.run(5)
    hovered = left - drone.sim.battery.remaining
    assert hovered == pytest.approx(20.0 * 5.0 / drone.sim.airframe.endurance_s, rel=0.02)
    drone.sim.inject("battery", True)
    drone.run(1)
    assert any("battery" in text.lower() for text in drone.texts())
    drone.sim.inject("battery", False)
    assert drone.sim.battery.remaining > 0.1


def test_flying_takes_more_than_standing():
    standing, flying = Drone().run(30), Drone().take_off().run(22)
    assert 1.0 - flying.sim.battery.remaining > 10.0 * (1.0 - standing.sim.battery.remaining)


def test_several_start_side_by_side():
    drones = [Drone(start=(0.0, 3.0 * number, 0.0), seed=number).take_off() for number in range(2)]
    assert drones[1].sim.p[:3] == pytest.approx((0.0, 3.0, 2.0), abs=0.05)
    assert drones[0].sim.p[:3] == pytest.approx((0.0, 0.0, 2.0), abs=0.05)
    assert drones[1].sim.autopilot.home[:3] == (0.0, 3.0, 0.0)


def test_an_obstacle_at_the_start_is_told():
    scenario = Scenario(obstacle=(Sphere("balloon", (0.0, 3.0, 0.5), 0.3),))
    build(scenario)
    with pytest.raises(ScenarioError, match="'balloon' is within .* of the pad at x 0, y 3"):
        build(scenario, start=(0.0, 3.0, 0.0))


@pytest.mark.parametrize("model", ["kinematic", "dynamic"])
def test_wind_changed_in_flight_is_felt(model):
    drone = Drone(Scenario(vehicle=VehicleChoice(model=model))).take_off()
    assert drone.sim.wind == (0.0, 0.0, 0.0)
    assert drone.sim.autopilot.parameters.set("SIM_WIND_N", 6.0)
    drone.run(0.5)
    assert drone.sim.wind == (0.0, 6.0, 0.0)
    moved = drone.sim.p[1]
    assert moved > 0.05 if model == "dynamic" else moved == pytest.approx(0.0, abs=1e-6)
