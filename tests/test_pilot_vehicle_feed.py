"""What the pilot takes from the bus: nothing that cannot be or is old, and points by which it runs into nothing."""

import math
from collections import deque
from random import Random

import pytest

from drivers.device import DeviceInfo, HandleState
from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.messages import (
    OBSTACLES,
    RING_SECTORS,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Phase,
    Ranges,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.pilot import Memory, Pilot
from groundstation.pilot.vehicle_feed import VehicleFeed
from groundstation.run_folder import new_run_id, sweep
from sim.environment.rangefinder import ring
from sim.environment.world import World
from sim.scenario import Cylinder, Wall

NAN, INF = math.nan, math.inf
NOTHING = [INF] * RING_SECTORS
RADIUS = 0.5


class Vehicle:
    """The link, as the feed sees it on a bus of its own."""

    def __init__(self, run_id):
        self.bus = Bus(run_id, "test")
        self.states = self.bus.publisher(VEHICLE_STATE)
        self.statuses = self.bus.publisher(VEHICLE_STATUS)
        self.ranges = self.bus.publisher(OBSTACLES)
        self.feed = VehicleFeed(self.bus, RADIUS)

    def is_at(self, t, *position, velocity=(0.0,) * 4, valid=1):
        record = VehicleState(t=t, boot_t=t, valid=valid)
        record.position[:], record.velocity[:] = position, velocity
        self.states.send(record)

    def says(self, t, rtt=NAN, loss=0.0):
        self.statuses.send(VehicleStatus(t=t, rtt=rtt, loss=loss, connected=1, armed=1, in_air=1))

    def sees(self, t, distances=NOTHING, below=NAN, above=NAN):
        record = Ranges(t=t, below=below, above=above, limit=12.0)
        record.ring[:] = distances
        self.ranges.send(record)

    def seen(self, now, ahead=None):
        """The points that matter at a place, or where the vehicle is."""
        self.feed.update(now, ahead or self.feed.sample.position)
        return self.feed.seen


@pytest.fixture
def vehicle():
    run_id = new_run_id()
    vehicle = Vehicle(run_id)
    yield vehicle
    vehicle.bus.close()
    sweep(run_id)


def ahead(distance):
    return [distance, *NOTHING[1:]]


@pytest.mark.parametrize(("clock", "believed"), [(1.0, True), (3e6, True), (NAN, False), (INF, False)])
def test_a_state_is_believed_however_long_the_machine_has_been_up(vehicle, clock, believed):
    vehicle.is_at(clock, 1.0, 2.0, 3.0, 0.0)
    vehicle.feed.update(clock, (0.0,) * 4)
    assert vehicle.feed.believable is believed


def test_what_is_ahead_is_placed_in_the_world(vehicle):
    vehicle.is_at(10.0, 1.0, 2.0, 3.0, math.pi / 2)
    vehicle.sees(10.01, ahead(2.0), below=1.2)
    (below, ahead_) = vehicle.seen(10.02, ahead=(1.0, 2.0, 3.0, 0.0))
    assert below == pytest.approx((1.0, 2.0, 1.8))
    assert ahead_ == pytest.approx((1.0, 4.0, 3.0))


def test_it_is_placed_from_where_the_vehicle_was_as_it_came(vehicle):
    vehicle.is_at(10.0, 0.0, 0.0, 2.0, 0.0, velocity=(2.0, 0.0, 0.0, 0.0))
    vehicle.sees(10.05, ahead(2.0))
    assert vehicle.seen(10.06, ahead=(0.2, 0.0, 2.0, 0.0)) == (pytest.approx((2.1, 0.0, 2.0)),)
    # The vehicle flies on, the thing stays where it is.
    vehicle.is_at(10.3, 0.6, 0.0, 2.0, 0.0)
    assert vehicle.seen(10.3, ahead=(0.6, 0.0, 2.0, 0.0)) == (pytest.approx((2.1, 0.0, 2.0)),)


def test_what_was_seen_half_a_second_ago_is_no_longer_there(vehicle):
    vehicle.is_at(10.0, 0.0, 0.0, 2.0, 0.0)
    vehicle.sees(10.0, ahead(2.0))
    assert vehicle.seen(10.5)
    assert vehicle.seen(10.51) == ()
    vehicle.is_at(10.52, 0.0, 0.0, 2.0, 0.0)
    assert vehicle.seen(10.52) == ()


def test_without_a_place_to_see_from_there_is_nothing(vehicle):
    vehicle.sees(10.0, ahead(2.0))
    assert vehicle.seen(10.0) == ()
    vehicle.is_at(10.1, 0.0, 0.0, 2.0, 0.0, valid=0)
    vehicle.sees(10.1, ahead(2.0))
    assert vehicle.seen(10.1) == ()
    vehicle.is_at(10.2, 0.0, 0.0, 2.0, 0.0)
    vehicle.sees(10.8, ahead(2.0))
    assert vehicle.seen(10.8) == ()


@pytest.mark.parametrize("t", [NAN, INF, -INF])
def test_a_record_of_no_time_is_none(vehicle, t):
    vehicle.is_at(10.0, 0.0, 0.0, 2.0, 0.0)
    vehicle.sees(t, ahead(2.0))
    assert vehicle.seen(10.0) == ()


@pytest.mark.parametrize("distance", [NAN, INF, -INF, -1.0, 0.0, 1e300])
def test_a_distance_that_cannot_be_is_no_point(vehicle, distance):
    vehicle.is_at(10.0, 0.0, 0.0, 2.0, 0.0)
    vehicle.sees(10.0, [distance] * RING_SECTORS, below=distance, above=distance)
    assert vehicle.seen(10.0) == ()


def test_the_points_are_those_that_matter_where_the_vehicle_will_be(vehicle):
    posts = World([Cylinder("near", (1.5, 1.5, 2.0), 0.2, 4.0), Cylinder("far", (4.0, -1.0, 2.0), 0.4, 4.0)])
    vehicle.is_at(10.0, 0.0, 0.0, 2.0, 0.0)
    vehicle.sees(10.0, ring(posts, (0.0, 0.0, 2.0, 0.0)))
    assert math.dist(vehicle.seen(10.0)[0][:2], (1.5, 1.5)) < 0.3
    vehicle.is_at(10.02, 0.0, 0.0, 2.0, 0.0)
    nearest = vehicle.seen(10.02, ahead=(3.0, 0.0, 1.5, 0.0))[0]
    assert math.dist(nearest[:2], (4.0, -1.0)) < 0.5
    # At the vehicle's height: nothing dives under a post.
    assert nearest[2] == 1.5


@pytest.mark.parametrize(
    ("rtt", "delay"), [(0.3, 0.3), (NAN, NAN), (INF, NAN), (-1.0, NAN), (0.0, NAN), (1e9, NAN)]
)
def test_the_delay_is_the_round_trip_or_not_known(vehicle, rtt, delay):
    vehicle.says(10.0, rtt=rtt)
    vehicle.seen(10.0)
    assert vehicle.feed.delay == pytest.approx(delay, nan_ok=True)


@pytest.mark.parametrize(("told", "loss"), [(0.3, 0.3), (0.0, 0.0), (NAN, 1.0), (-0.1, 1.0), (7.0, 1.0)])
def test_a_loss_that_cannot_be_is_taken_for_the_worst(vehicle, told, loss):
    vehicle.says(10.0, loss=told)
    vehicle.seen(10.0)
    assert vehicle.feed.loss == loss


DEVICE = DeviceInfo("test", "", 4, 0.1, 10.0, 1000.0, 1000.0, "nothing")
STEP_S, TELEMETRY, RANGES = 0.005, 4, 20
LAG_S = 0.3


def least_clearance(vehicle, solids, hand, *, delay, loss, seconds=6.0):
    """Fly with the handle pushed, over a link, against what only the sensors see.

    Returns:
        The least distance from hull to obstacle, m, and how far the vehicle got along y.
    """
    world, random = World(solids), Random(3)
    pilot, memory = Pilot(Settings(), DEVICE), Memory()
    handle = HandleState(hand, (0.0, 0.0, 0.0), 0.0, 0, homed=True, device_time=0.0)
    down, up = deque(), deque()
    p, v, flown, least = [0.0, 0.0, 2.0, 0.0], [0.0] * 4, (0.0,) * 4, INF
    for n in range(round(seconds / STEP_S)):
        t = 10.0 + n * STEP_S
        if n % TELEMETRY == 0 and random.random() >= loss:
            down.append((t + delay / 2, lambda t, p=tuple(p), v=tuple(v): vehicle.is_at(t, *p, velocity=v)))
        if n % RANGES == 0 and random.random() >= loss:
            distances = [d + random.gauss(0.0, 0.02) for d in ring(world, tuple(p))]
            down.append((t + delay / 2, lambda t, distances=distances: vehicle.sees(t, distances)))
            vehicle.says(t, rtt=delay or NAN, loss=loss)
        while down and down[0][0] <= t + 1e-9:
            down.popleft()[1](t)
        vehicle.feed.update(t, memory.forecast.p if memory.coupled else vehicle.feed.sample.position)
        feed, age = vehicle.feed, t - vehicle.feed.state_t
        phase = Phase.ENGAGED if age < 0.5 else Phase.DISENGAGED
        inputs = Inputs(STEP_S, phase, False, handle, feed.sample, age, feed.delay, feed.loss, seen=feed.seen)
        memory, outputs = pilot.step(memory, inputs)
        if n % TELEMETRY == 0 and random.random() >= loss:
            up.append((t + delay / 2, outputs.setpoint))
        while up and up[0][0] <= t + 1e-9:
            flown = up.popleft()[1]
        for axis in range(3):
            v[axis] += STEP_S / LAG_S * (flown[axis] - v[axis])
            p[axis] += STEP_S * v[axis]
        least = min(least, *(solid.distance(p[0], p[1], p[2]) for solid in world.solids))
    return least - RADIUS, p[1]


WALL = [Wall("wall", (3.0, -60.0), (3.0, 60.0), 6.0)]
POSTS = [Cylinder(f"{i}", (1.0 + 0.9 * math.sin(2.1 * i), 2.5 + 2.2 * i, 2.0), 0.2, 6.0) for i in range(8)]


@pytest.mark.parametrize(("delay", "loss"), [(0.0, 0.0), (0.3, 0.3), (0.7, 0.3)])
def test_a_vehicle_that_is_pushed_at_a_wall_slides_along_it(vehicle, delay, loss):
    clearance, way = least_clearance(vehicle, WALL, (0.07, 0.07, 0.0), delay=delay, loss=loss)
    assert clearance > 0.1
    assert way > 1.0


@pytest.mark.parametrize(("delay", "loss"), [(0.0, 0.3), (0.7, 0.0)])
def test_a_vehicle_that_is_pushed_into_posts_touches_none(vehicle, delay, loss):
    clearance, _ = least_clearance(vehicle, POSTS, (0.03, 0.1, 0.0), delay=delay, loss=loss)
    assert clearance > 0.1
