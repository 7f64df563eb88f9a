"""Missions in virtual time: every action, index and reached items, what cannot be flown, and the end."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sim_flight import DT, Flight

from sim.autopilot.guidance import Target
from sim.autopilot.mission import mission_fault
from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Action, Circle, Leg, Plan, Polygon


def waypoint(x, y, z=3.0, **more):
    return Leg(Action.WAYPOINT, (x, y, z), above_home=True, **more)


TAKEOFF = Leg(Action.TAKEOFF, (None, None, 3.0), above_home=True)
LAND = Leg(Action.LAND)


class OnMission(Flight):
    """A vehicle with a mission, which notes the way it takes."""

    def __init__(self, *legs, model="kinematic", **named):
        super().__init__(model, **named)
        self.way = []
        self.reached = []
        self._count = 0
        assert self.autopilot.load_mission(legs).ok

    def start(self):
        assert self.autopilot.set_mode(Mode.MISSION).ok
        assert self.autopilot.arm().ok
        return self

    def run(self, seconds, each=lambda: None):
        def both():
            each()
            self.way.append(self.sim.p)
            if self.autopilot.mission_reached_count != self._count:
                self._count = self.autopilot.mission_reached_count
                self.reached.append(self.autopilot.mission_reached)

        super().run(seconds, both)

    def finish(self, at_most=120):
        self.until(lambda: self.autopilot.mission_finished, at_most)
        self.run(0.1)
        return self

    def nearest(self, x, y):
        return min(math.hypot(p[0] - x, p[1] - y) for p in self.way)

    @property
    def index(self):
        return self.autopilot.mission_index


@pytest.mark.parametrize(
    ("model", "airframe"), [("kinematic", "matrice_100"), ("dynamic", "matrice_100"), ("rigid_body", "x500")]
)
def test_a_mission_from_pad_to_pad(model, airframe):
    landing = Leg(Action.LAND, (0.0, 5.0, 0.0))
    legs = (TAKEOFF, waypoint(15, 0), waypoint(15, 10, 5.0), landing)
    flight = OnMission(*legs, model=model, airframe=airframe).start()
    flight.until(lambda: not flight.autopilot.armed, 120)
    flight.run(DT)
    assert flight.reached == [0, 1, 2, 3]
    assert flight.nearest(15, 0) <= 2.0
    assert flight.nearest(15, 10) <= 2.0
    assert flight.sim.p[:3] == pytest.approx((0.0, 5.0, 0.0), abs=0.6)
    assert flight.autopilot.mission_finished
    assert "Mission finished" in flight.texts
    assert flight.mode is Mode.HOLD
    assert not flight.sim.collisions


def test_it_ends_in_hold_at_the_last_place_and_begins_anew():
    flight = OnMission(TAKEOFF, waypoint(12, 0)).start().finish()
    assert flight.mode is Mode.HOLD
    assert not flight.autopilot.failsafe
    flight.run(5)
    assert flight.sim.p[:3] == pytest.approx((12, 0, 3), abs=0.1)
    assert flight.autopilot.set_mode(Mode.MISSION).ok
    flight.run(DT)
    assert flight.index == 0
    assert not flight.autopilot.mission_finished
    flight.finish()
    assert flight.reached == [0, 1, 0, 1]


def test_without_take_off_item_it_climbs_to_the_first_place_or_the_least_height():
    flight = OnMission(waypoint(10, 0, 1.0)).set("MIS_TAKEOFF_ALT", 4.0).start().finish()
    leaves = next(p for p in flight.way if math.hypot(p[0], p[1]) > 0.5)
    assert leaves[2] == pytest.approx(4.0, abs=0.3)


def test_how_near_is_there():
    flight = OnMission(TAKEOFF, waypoint(20, 0), waypoint(20, 20)).set("NAV_ACC_RAD", 5.0).start().finish()
    assert 3.0 < flight.nearest(20, 0) <= 5.0
    flight = OnMission(TAKEOFF, waypoint(20, 0, radius=0.5), waypoint(20, 20)).start().finish()
    assert flight.nearest(20, 0) <= 0.5


def test_the_height_is_waited_for_too():
    flight = OnMission(TAKEOFF, waypoint(3, 0, 15.0), waypoint(3, 8, 15.0)).set("NAV_MC_ALT_RAD", 0.3)
    flight.start().until(lambda: flight.index == 2, 60)
    assert flight.sim.p[2] == pytest.approx(15.0, abs=0.3)


def test_hold_loiter_time_and_delay_take_their_time():
    legs = (TAKEOFF, waypoint(5, 0, hold_s=3.0), Leg(Action.DELAY, hold_s=2.0), LAND)
    flight = OnMission(*legs).start()
    flight.until(lambda: flight.index == 1, 30)
    flight.until(lambda: math.hypot(flight.sim.p[0] - 5, flight.sim.p[1]) <= 2.0, 30)
    t = flight.sim.t
    flight.until(lambda: flight.index == 2, 30)
    assert flight.sim.t - t == pytest.approx(3.0, abs=0.05)
    t = flight.sim.t
    flight.until(lambda: flight.index == 3, 30)
    assert flight.sim.t - t == pytest.approx(2.0, abs=0.05)
    timed = Leg(Action.LOITER_TIME, (5.0, 0.0, 3.0), hold_s=4.0)
    flight = OnMission(TAKEOFF, timed, waypoint(9, 0)).start()
    flight.until(lambda: flight.index == 2, 60)
    assert flight.sim.p[:2] == pytest.approx((5, 0), abs=0.1)


def test_loiter_is_for_ever_until_another_item_is_chosen():
    flight = OnMission(TAKEOFF, Leg(Action.LOITER, (6.0, 0.0, 3.0)), waypoint(0, 6)).start()
    flight.run(40)
    assert flight.index == 1
    assert flight.sim.p[:3] == pytest.approx((6, 0, 3), abs=0.1)
    assert flight.autopilot.set_mission_index(2).ok
    flight.finish()
    assert flight.sim.p[:2] == pytest.approx((0, 6), abs=2.0)
    assert not flight.autopilot.set_mission_index(3).ok


def test_speed_is_changed_for_the_rest_of_the_mission():
    legs = (TAKEOFF, waypoint(30, 0), Leg(Action.CHANGE_SPEED, value=2.0), waypoint(60, 0), waypoint(60, 10))
    flight = OnMission(*legs).start()
    flight.until(lambda: flight.sim.p[0] > 15, 30)
    assert flight.sim.v[0] == pytest.approx(5.0, rel=0.05)
    flight.until(lambda: flight.sim.p[0] > 45, 30)
    assert math.hypot(*flight.sim.v[:2]) == pytest.approx(2.0, rel=0.05)
    flight.finish()
    flight.autopilot.reposition((0.0, 10.0, 3.0), None)
    flight.run(5)
    assert math.hypot(*flight.sim.v[:2]) == pytest.approx(5.0, rel=0.05)


def test_jumps_are_counted():
    legs = (TAKEOFF, waypoint(6, 0), waypoint(0, 0), Leg(Action.JUMP, value=1, repeat=2), waypoint(0, 6))
    flight = OnMission(*legs).start().finish()
    assert flight.reached == [0, 1, 2, 3, 1, 2, 3, 1, 2, 3, 4]


def test_an_endless_circle_of_jumps_flies_on_and_can_be_left():
    flight = OnMission(TAKEOFF, Leg(Action.JUMP, value=1, repeat=10**6)).start()
    flight.run(10)
    assert flight.mode is Mode.MISSION
    assert flight.sim.p[2] == pytest.approx(3.0, abs=0.2)
    assert flight.autopilot.set_mode(Mode.LAND).ok
    flight.until(lambda: not flight.autopilot.armed, 20)


def test_a_return_item_changes_to_return():
    flight = OnMission(TAKEOFF, waypoint(8, 0), Leg(Action.RETURN)).start()
    flight.until(lambda: flight.mode is Mode.RETURN, 30)
    assert flight.reached == [0, 1]
    flight.until(lambda: not flight.autopilot.armed, 90)
    assert flight.sim.p[:2] == pytest.approx((0, 0), abs=0.6)


def test_left_and_taken_up_again_it_goes_on_where_it_was():
    flight = OnMission(TAKEOFF, waypoint(8, 0), waypoint(8, 12), waypoint(0, 12)).start()
    flight.until(lambda: flight.index == 2, 60)
    assert flight.autopilot.set_mode(Mode.HOLD).ok
    flight.run(5)
    assert flight.index == 2
    assert flight.speed < 0.1
    flight.autopilot.set_mode(Mode.MISSION)
    flight.finish()
    assert flight.reached == [0, 1, 2, 3]


def test_yaw_is_turned_to_and_waited_for():
    flight = OnMission(TAKEOFF, waypoint(1, 0, yaw=2.0), waypoint(8, 0)).set("MIS_YAW_ERR", 5.0).start()
    flight.until(lambda: flight.index == 2, 60)
    assert flight.sim.p[3] == pytest.approx(2.0, abs=math.radians(5.1))


@pytest.mark.parametrize(
    ("mode", "yaw"), [(0, math.pi / 2), (1, -math.pi / 2), (2, math.pi / 2), (3, math.pi / 2)]
)
def test_where_the_nose_points_on_the_way(mode, yaw):
    flight = OnMission(TAKEOFF, waypoint(0, 40)).set("MPC_YAW_MODE", mode).start()
    flight.until(lambda: flight.sim.p[1] > 25, 60)
    assert flight.sim.p[3] == pytest.approx(yaw, abs=0.1)


def test_items_that_are_nothing_here_are_passed_over():
    flight = OnMission(TAKEOFF, Leg(Action.NOTHING), waypoint(5, 0)).start().finish()
    assert flight.reached == [0, 1, 2]


def test_heights_count_from_home_or_from_the_world():
    flight = OnMission(TAKEOFF, waypoint(6, 0, 4.0))
    flight.autopilot.set_home((0.0, 0.0, 2.0, 0.0))
    flight.start().finish().run(5)
    assert flight.sim.p[2] == pytest.approx(6.0, abs=0.1)
    flight = OnMission(TAKEOFF, Leg(Action.WAYPOINT, (6.0, 0.0, 4.0)))
    flight.autopilot.set_home((0.0, 0.0, 2.0, 0.0))
    flight.start().finish().run(5)
    assert flight.sim.p[2] == pytest.approx(4.0, abs=0.1)


def test_another_mission_in_flight_begins_at_once_and_none_ends_it():
    flight = OnMission(TAKEOFF, waypoint(30, 0)).start()
    flight.until(lambda: flight.sim.p[0] > 5, 30)
    assert flight.autopilot.load_mission((waypoint(5, 20),)).ok
    assert flight.index == 0
    flight.finish()
    assert flight.sim.p[:2] == pytest.approx((5, 20), abs=2.0)
    flight.autopilot.set_mode(Mode.MISSION)
    assert flight.autopilot.load_mission(()).ok
    flight.run(DT)
    assert flight.mode is Mode.HOLD
    assert flight.texts[-1] == "Mission ended: no mission is on board"


def test_after_take_off_a_mission_may_follow():
    flight = OnMission(waypoint(10, 0)).set("COM_TAKEOFF_ACT", 1)
    assert flight.autopilot.arm().ok
    assert flight.autopilot.take_off(3.0).ok
    flight.until(lambda: flight.mode is Mode.MISSION, 20)
    flight.finish()


# What cannot be flown


PLACES = (TAKEOFF, waypoint(10, 0), LAND)


@pytest.mark.parametrize(
    ("plan", "values", "fault"),
    [
        (Plan(), {}, "no mission is on board"),
        (Plan((Leg(Action.DELAY, hold_s=1.0),)), {}, "it has no place to fly to"),
        (
            Plan(PLACES, (Circle((0.0, 0.0), 5.0, inclusion=True),)),
            {},
            "item 2 is outside of the inclusion zone",
        ),
        (Plan(PLACES, (Circle((9.0, 0.0), 5.0, inclusion=False),)), {}, "item 2 is inside an exclusion zone"),
        (Plan(PLACES), {"GF_MAX_HOR_DIST": 8.0}, "item 2 is farther than 8 m from home"),
        (Plan(PLACES), {"GF_MAX_VER_DIST": 2.0}, "item 2 is higher than 2 m above home"),
        (
            Plan(PLACES[1:]),
            {"MIS_TKO_LAND_REQ": 1},
            "a take-off is required as its first place (MIS_TKO_LAND_REQ)",
        ),
        (Plan(PLACES[:2]), {"MIS_TKO_LAND_REQ": 2}, "a landing is required (MIS_TKO_LAND_REQ)"),
        (Plan(PLACES[:2]), {"MIS_TKO_LAND_REQ": 4}, "a landing is required (MIS_TKO_LAND_REQ)"),
        (
            Plan(PLACES[1:]),
            {"MIS_TKO_LAND_REQ": 4},
            "a take-off is required as its first place (MIS_TKO_LAND_REQ)",
        ),
        (Plan(PLACES), {"MIS_TKO_LAND_REQ": 3}, ""),
        (Plan(PLACES[1:2]), {"MIS_TKO_LAND_REQ": 4}, ""),
        (Plan(PLACES), {"GF_MAX_HOR_DIST": 8.0, "GF_ACTION": 0}, ""),
    ],
)
def test_a_mission_is_judged_before_it_is_flown(plan, values, fault):
    parameters = Parameters()
    for name, value in values.items():
        assert parameters.set(name, value)
    assert mission_fault(plan, (0.0, 0.0, 0.0, 0.0), parameters) == fault


def test_a_mission_that_cannot_be_flown_is_refused_with_words():
    flight = Flight()
    assert flight.autopilot.set_mode(Mode.MISSION).why == "no mission is on board"
    assert flight.autopilot.load_mission((Leg(Action.JUMP, value=3),)).why == (
        "item 1 jumps to an item that is not there"
    )
    assert flight.autopilot.plan.mission == ()
    flight.set("COM_ARM_MIS_REQ", 1)
    assert "a mission is required" in flight.autopilot.arming_obstacle()


def test_a_first_place_far_away_is_only_told():
    flight = OnMission(TAKEOFF, waypoint(60, 0)).set("MIS_DIST_1WP", 50.0)
    assert flight.autopilot.set_mode(Mode.MISSION).ok
    flight.run(DT)
    assert flight.texts == ["First waypoint is far away: 60 m"]


def test_a_fence_breached_on_the_way_holds_and_the_mission_does_not_go_on_by_itself():
    flight = OnMission(TAKEOFF, waypoint(20, 0)).set("COM_FAIL_ACT_T", 0.0)
    wall = Polygon(((8.0, -5.0), (12.0, -5.0), (12.0, 5.0), (8.0, 5.0)), inclusion=False)
    assert flight.autopilot.load_fence((wall,)).ok
    flight.start().until(lambda: flight.mode is Mode.HOLD, 60)
    flight.run(10)
    assert 8.0 <= flight.sim.p[0] < 13.0
    assert flight.mode is Mode.HOLD


LEGS = st.lists(
    st.one_of(
        st.builds(
            Leg,
            st.sampled_from((Action.WAYPOINT, Action.LOITER_TIME, Action.TAKEOFF, Action.LAND)),
            st.tuples(*(st.none() | st.floats(-15, 15),) * 2, st.none() | st.floats(0, 9)),
            st.booleans(),
            st.none() | st.floats(-3, 3),
            st.floats(0, 2),
            st.floats(0, 3),
        ),
        st.just(Leg(Action.DELAY, hold_s=0.5)),
        st.just(Leg(Action.NOTHING)),
        st.just(Leg(Action.RETURN)),
        st.builds(Leg, st.just(Action.CHANGE_SPEED), value=st.floats(-1, 6)),
        st.builds(Leg, st.just(Action.JUMP), value=st.integers(0, 3).map(float), repeat=st.integers(0, 3)),
    ),
    min_size=1,
    max_size=5,
)


@settings(max_examples=25, deadline=None)
@given(LEGS)
def test_whatever_is_planned_is_refused_or_flown_without_harm(legs):
    flight = Flight("kinematic")
    if not flight.autopilot.load_mission(tuple(legs)).ok or not flight.autopilot.set_mode(Mode.MISSION).ok:
        return
    assert flight.autopilot.arm().ok
    for _ in range(1000):
        flight.sim.step(0.02)
        assert all(map(math.isfinite, (*flight.sim.p, *flight.sim.v)))
        assert math.hypot(*flight.sim.v[:2]) <= 5.01
    assert flight.autopilot.target == Target(*flight.autopilot.target)
