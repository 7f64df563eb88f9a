"""The geofence: zones against a reference, limits about home, and what a breach does."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from sim_flight import Flight

from sim.autopilot.fence import breach, inside
from sim.autopilot.guidance import Target
from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Circle, Polygon

HOME = (0.0, 0.0, 0.0, 0.0)
SQUARE = ((-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0))
COORDINATE = st.floats(-50, 50).map(lambda value: round(value, 3))
POINT = st.tuples(COORDINATE, COORDINATE)


def winding(corners, x, y):
    """Return how often a polygon goes round a point: the sum of the angles its edges are seen under."""
    turned = 0.0
    for (xa, ya), (xb, yb) in zip(corners, corners[1:] + corners[:1], strict=True):
        ax, ay, bx, by = xa - x, ya - y, xb - x, yb - y
        turned += math.atan2(ax * by - ay * bx, ax * bx + ay * by)
    return round(turned / math.tau)


def near_an_edge(corners, x, y):
    for (xa, ya), (xb, yb) in zip(corners, corners[1:] + corners[:1], strict=True):
        length = math.hypot(xb - xa, yb - ya)
        along = ((x - xa) * (xb - xa) + (y - ya) * (yb - ya)) / length**2 if length else 0.0
        along = max(0.0, min(1.0, along))
        if math.hypot(xa + along * (xb - xa) - x, ya + along * (yb - ya) - y) < 1e-6:
            return True
    return False


@given(st.lists(POINT, min_size=3, max_size=9).map(tuple), POINT)
def test_inside_is_an_odd_number_of_turns(corners, point):
    """Also of polygons that cross themselves."""
    assume(not near_an_edge(corners, *point))
    assert inside(corners, *point) == (winding(corners, *point) % 2 == 1)


@given(st.lists(st.floats(0, math.tau), min_size=3, max_size=8, unique=True), POINT, st.floats(0.1, 30))
def test_a_polygon_round_a_circle_contains_what_all_its_edges_leave_on_the_left(angles, point, radius):
    angles = sorted(angles)
    assume(min(b - a for a, b in zip(angles, [*angles[1:], angles[0] + math.tau], strict=True)) > 1e-3)
    corners = tuple((radius * math.cos(angle), radius * math.sin(angle)) for angle in angles)
    assume(not near_an_edge(corners, *point))
    x, y = point
    left = all(
        (xb - xa) * (y - ya) - (yb - ya) * (x - xa) > 0.0
        for (xa, ya), (xb, yb) in zip(corners, corners[1:] + corners[:1], strict=True)
    )
    assert inside(corners, x, y) == left


def test_zones_one_inclusion_is_enough_and_no_exclusion_may_hold():
    zones = (
        Polygon(SQUARE, inclusion=True),
        Circle((30.0, 0.0), 5.0, inclusion=True),
        Circle((0.0, 0.0), 2.0, inclusion=False),
    )
    where = {
        point: breach((*point, 5.0), HOME, zones, Parameters())
        for point in ((5.0, 5.0), (28.0, 1.0), (20.0, 0.0), (1.0, 1.0))
    }
    assert where == {
        (5.0, 5.0): "",
        (28.0, 1.0): "",
        (20.0, 0.0): "outside of the inclusion zone",
        (1.0, 1.0): "inside an exclusion zone",
    }


@given(POINT, st.floats(0, 60), st.floats(1, 60), st.floats(1, 60))
def test_the_cylinder_about_home(point, height, far, high):
    parameters = Parameters()
    parameters.set("GF_MAX_HOR_DIST", far)
    parameters.set("GF_MAX_VER_DIST", high)
    home = (3.0, -2.0, 1.0, 0.0)
    out = math.hypot(point[0] - 3.0, point[1] + 2.0) > far or height - 1.0 > high
    assert bool(breach((*point, height), home, (), parameters)) == out


@pytest.mark.parametrize(
    ("zones", "why"),
    [
        ((Polygon(SQUARE[:2], inclusion=True),), "a polygon needs three corners"),
        ((Circle((0.0, 0.0), 0.0, inclusion=True),), "a circle needs a radius"),
    ],
)
def test_what_is_no_fence_is_refused(zones, why):
    flight = Flight()
    verdict = flight.autopilot.load_fence(zones)
    assert (verdict.ok, verdict.why) == (False, why)
    assert flight.autopilot.plan.fence == ()


def out_of_the_fence(action, **values):
    """Fly out to the east at 2 m/s until the fence is breached."""
    flight = Flight("kinematic").set("GF_ACTION", action, "COM_FAIL_ACT_T", 0.0)
    for name, value in values.items():
        flight.set(name, value)
    assert flight.autopilot.load_fence((Polygon(SQUARE, inclusion=True),)).ok
    flight.take_off(5.0)
    flight.follow(Target(velocity=(2.0, 0.0, 0.0)), 4.0)
    return flight.until(
        lambda: flight.autopilot.fence_breach,
        4.0,
        lambda: flight.autopilot.offboard(Target(velocity=(2.0, 0.0, 0.0))),
    )


@pytest.mark.parametrize(
    ("action", "mode"),
    [(0, Mode.OFFBOARD), (1, Mode.OFFBOARD), (2, Mode.HOLD), (3, Mode.RETURN), (5, Mode.LAND)],
)
def test_a_breach_does_what_the_parameter_says(action, mode):
    flight = out_of_the_fence(action)
    assert flight.mode is mode
    assert flight.sim.p[0] == pytest.approx(10.0, abs=0.1)
    assert any("Geofence breached" in text for text in flight.texts) == (action > 0)
    assert flight.autopilot.failsafe == (action > 1)


def test_a_breach_may_terminate():
    flight = out_of_the_fence(4)
    assert flight.autopilot.terminated
    assert not flight.autopilot.armed


def test_the_operator_may_bring_it_back_and_is_not_seized_again():
    flight = out_of_the_fence(2)
    flight.run(3, lambda: flight.autopilot.offboard(Target(velocity=(2.0, 0.0, 0.0))))
    assert flight.mode is Mode.HOLD
    flight.follow(Target(velocity=(-2.0, 0.0, 0.0)), 3.0)
    assert flight.mode is Mode.OFFBOARD
    assert flight.autopilot.fence_breach == ""
    assert flight.sim.p[0] < 9.0
    told = sum("Geofence" in text for text in flight.texts)
    assert told == 1
    flight.until(
        lambda: flight.autopilot.fence_breach,
        4.0,
        lambda: flight.autopilot.offboard(Target(velocity=(2.0, 0.0, 0.0))),
    )
    assert flight.mode is Mode.HOLD


def test_a_breach_may_be_foreseen():
    """By the way that braking takes: v²/2a."""
    flight = out_of_the_fence(2, GF_PREDICT=1, MPC_ACC_HOR=2.0)
    assert flight.sim.p[0] == pytest.approx(10.0 - 2.0**2 / (2 * 2.0), abs=0.1)


def test_outside_of_the_fence_nothing_is_armed():
    flight = Flight()
    flight.autopilot.load_fence((Circle((0.0, 0.0), 3.0, inclusion=False),))
    flight.run(0.1)
    assert flight.autopilot.arming_obstacle() == "geofence breached: inside an exclusion zone"
    flight.set("GF_ACTION", 0)
    assert flight.autopilot.arm().ok
