"""What a flight is measured by, on flights whose numbers are known."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.director import Stage
from groundstation.training.measurer import HandSight, Measurer, VehicleSight
from groundstation.training.mission import Landing, Mission, Target
from groundstation.training.way import off_the_way, way_of
from sim.scenario import Pad, Sphere

RADIUS = 0.2
STEP = 0.02
MISSION = Mission(
    schema=1,
    name="there",
    title="There and down",
    route=((4.0, 0.0, 2.0),),
    target=Target((8.0, 0.0, 2.0), radius=0.3, hold_s=0.5),
    landing=Landing("pad"),
    pad=(Pad("pad", (10.0, 0.0, 0.0), radius=0.5),),
    obstacle=(Sphere("pillar", (4.0, 1.5, 2.0), 0.3),),
)

FREE = Mission(schema=1, name="free", title="Nothing is asked for")


def flown(
    y: float = 0.0, force: float = 2.0, error: float = 0.3, changed: float = 0.1, mission: Mission = MISSION
) -> Measurer:
    """Fly the mission along y, 1 m/s, to where it ends."""
    measurer = Measurer(mission, RADIUS)
    t = 0.0

    def go(x: float, z: float, *, coupled: bool, armed: bool = True, speed: float = 1.0) -> None:
        nonlocal t
        t += STEP
        measurer.hand(
            HandSight(t - 0.01, coupled, (0.0, error, 0.0), changed, (0.0, 0.0, -force), on_leash=False)
        )
        measurer.vehicle(VehicleSight(t, (x, y, z, 0.0), (speed, 0.0, 0.0), armed, armed))

    for height in range(101):
        go(0.0, 0.02 * height, coupled=False)
    for way in range(1, 401):
        go(STEP * way, 2.0, coupled=True)
    for _ in range(30):
        go(8.0, 2.0, coupled=True, speed=0.0)
    for way in range(1, 101):
        go(8.0 + STEP * way, 2.0, coupled=True)
    for height in range(100, -1, -1):
        go(10.2, 0.02 * height, coupled=False)
    go(10.2, 0.0, coupled=False, armed=False)
    return measurer


def test_a_flight_has_the_numbers_it_was_flown_with():
    measurer = flown(y=0.1)
    found = measurer.measures()
    assert measurer.director.stage is Stage.DONE
    assert found.time_s == pytest.approx(STEP * (100 + 400 + 30 + 100 + 101 + 1))
    assert found.reached == 1.0
    assert found.rms_error_m == pytest.approx(0.3)
    assert found.effort_n == pytest.approx(2.0)
    assert found.disagreement_mps == pytest.approx(0.1)
    assert found.path_error_m == pytest.approx(0.1, abs=0.02)
    assert found.least_clearance_m == pytest.approx(1.5 - 0.1 - 0.3 - RADIUS, abs=1e-3)
    assert found.final_error_m == pytest.approx(math.hypot(0.1, 0.0), abs=0.31)
    assert found.landing_error_m == pytest.approx(math.hypot(0.2, 0.1))
    assert found.collisions == 0
    assert found.smoothness < -1.0
    assert math.isnan(found.gates_missed)


def test_a_flight_that_is_not_judged_has_its_numbers_and_its_way_and_keeps_nothing_else():
    """Hours of flying free take no more memory, and no longer to measure."""
    judged, free = flown(y=0.1), flown(y=0.1, mission=FREE)
    assert len(judged.hand_rows) > len(free.hand_rows) == len(free.vehicle_rows) == 0
    one, other = judged.measures(), free.measures()
    for name in ("time_s", "rms_error_m", "smoothness", "disagreement_mps", "effort_n"):
        assert getattr(one, name) == getattr(other, name)
    assert free.track() == judged.track()


def test_the_way_has_a_place_every_so_often_and_stands_where_nobody_leads():
    track = flown(y=0.1).track()
    lasted = STEP * (100 + 400 + 30 + 100 + 101 + 1)
    assert len(track.points) == pytest.approx(lasted / track.every_s, abs=1)
    # Two seconds of climbing by itself, eight along x, and half a second there.
    for at, x in ((0.0, STEP), (1.9, STEP), (6.0, 4.0), (10.2, 8.0), (lasted - 0.1, 10.0)):
        assert track.points[int(at / track.every_s)][0] == pytest.approx(x, abs=0.25)
    assert Measurer(MISSION, RADIUS).track().points == ()


def test_before_take_off_nothing_is_measured():
    measurer = Measurer(MISSION, RADIUS)
    measurer.hand(HandSight(0.0, True, (1.0, 0.0, 0.0), 1.0, (9.0, 0.0, 0.0)))
    measurer.vehicle(VehicleSight(0.1, (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), False, False))
    assert len(measurer.hand_rows) == len(measurer.vehicle_rows) == 0
    assert math.isnan(measurer.measures().time_s)


def test_after_the_landing_nothing_is_added():
    measurer = flown()
    before = measurer.measures()
    measurer.hand(HandSight(99.0, True, (5.0, 0.0, 0.0), 1.0, (9.0, 0.0, 0.0)))
    measurer.vehicle(VehicleSight(99.1, (50.0, 0.0, 2.0, 0.0), (9.0, 0.0, 0.0), True, True))
    assert measurer.measures() == before


def test_a_collision_is_kept_with_its_time_and_name():
    measurer = flown(y=1.0)
    ((t, name),) = measurer.collisions
    assert (name, measurer.measures().collisions) == ("pillar", 1)
    assert t == pytest.approx(STEP * (101 + 190), abs=0.3)


def test_without_a_hand_there_is_only_what_the_vehicle_did():
    measurer = Measurer(MISSION, RADIUS)
    for row in range(200):
        measurer.vehicle(VehicleSight(STEP * row, (0.0, 0.0, 2.0, 0.0), (0.0, 0.0, 0.0), True, True))
    found = measurer.measures()
    assert found.time_s == pytest.approx(STEP * 199)
    assert all(math.isnan(each) for each in (found.rms_error_m, found.effort_n, found.smoothness))
    assert found.reached == 0.0


def test_the_way_leads_over_the_pad_down_to_it():
    assert way_of(MISSION)[-2:] == ((10.0, 0.0, 2.0), (10.0, 0.0, 0.0))


def test_off_the_way_looks_at_the_leg_under_way_and_the_one_before():
    eight = ((0.0, 0.0, 2.0), (4.0, 0.0, 2.0), (4.0, 4.0, 2.0), (0.0, 4.0, 2.0))
    assert off_the_way(eight, 0, (2.0, 1.0, 2.0)) == pytest.approx(1.0)
    assert off_the_way(eight, 2, (2.0, 1.0, 2.0)) == pytest.approx(2.0)
    assert off_the_way(eight, 99, (2.0, 3.0, 2.0)) == pytest.approx(1.0)
    assert math.isnan(off_the_way(eight[:1], 0, (0.0, 0.0, 0.0)))
    assert off_the_way((eight[0], eight[0]), 0, (0.0, 3.0, 2.0)) == pytest.approx(3.0)


@given(st.floats(-50, 50), st.floats(-50, 50), st.floats(-5, 20), st.integers(0, 9))
def test_no_place_is_further_off_than_from_the_ends_of_its_legs(x, y, z, leg):
    way = way_of(MISSION)
    found = off_the_way(way, leg, (x, y, z))
    now = min(leg, len(way) - 2)
    assert 0.0 <= found <= min(math.dist((x, y, z), way[now]), math.dist((x, y, z), way[now + 1])) + 1e-9
