"""Half-spaces, what is near, and what the guards make of a velocity."""

from itertools import combinations
from math import hypot, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.device import ZERO3
from groundstation.config import Limits, Shield
from groundstation.pilot.margin import COMPENSATED, lags_of
from groundstation.pilot.shield.barrier import Barrier
from groundstation.pilot.shield.guard import Off, Situation
from groundstation.pilot.shield.halfspaces import nearest_within
from groundstation.pilot.shield.nearby import Candidates, Near, Neighbourhood, nearest
from groundstation.pilot.shield.risk_field import RiskField
from groundstation.pilot.surroundings import Surroundings
from groundstation.training.mission import Fence
from sim.airframe import load_airframe
from sim.environment.world import World
from sim.scenario import Box, Cylinder, Sphere

SETTINGS, LIMITS = Shield(), Limits()
BARRIER = Barrier(SETTINGS, LIMITS, COMPENSATED)

numbers = st.floats(-3, 3)
directions = (
    st.tuples(numbers, numbers, numbers)
    .filter(lambda v: hypot(*v) > 0.1)
    .map(lambda v: tuple(x / hypot(*v) for x in v))
)
halfspaces = st.lists(st.tuples(directions, st.floats(-2, 0.5)), max_size=6)
points = st.tuples(numbers, numbers, numbers)


def dot(a, b) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def best_by_trying(wanted, planes):
    """Every vertex, edge and plane that the best point could lie on, and the best of those within all."""
    tried = [np.array(wanted)]
    for size in (1, 2, 3):
        for some in combinations(planes, size):
            normals, offsets = np.array([n for n, _ in some]), np.array([c for _, c in some])
            lift, *_ = np.linalg.lstsq(normals @ normals.T, offsets - normals @ wanted, rcond=None)
            tried.append(np.array(wanted) + normals.T @ lift)
    within = [x for x in tried if all(np.dot(n, x) >= c - 1e-6 for n, c in planes)]
    return min((float(np.linalg.norm(x - wanted)) for x in within), default=None)


@given(points, halfspaces)
def test_the_nearest_point_is_as_near_as_any_that_trying_finds(wanted, planes) -> None:
    found, best = nearest_within(wanted, planes), best_by_trying(wanted, planes)
    if found is None:
        return
    assert all(dot(normal, found) >= offset - 1e-5 for normal, offset in planes)
    assert best is not None
    assert hypot(*(a - b for a, b in zip(found, wanted, strict=True))) <= best + 1e-4


def test_a_corner_of_three_planes_and_a_slit_that_leaves_nothing() -> None:
    corner = [((1.0, 0.0, 0.0), 0.0), ((0.0, 1.0, 0.0), 0.0), ((0.0, 0.0, 1.0), 1.0)]
    assert nearest_within((-1.0, -2.0, 0.0), corner) == pytest.approx((0.0, 0.0, 1.0))
    assert nearest_within((3.0, -2.0, 2.0), corner) == pytest.approx((3.0, 0.0, 2.0))
    assert nearest_within((0.0, 0.0, 0.0), [((1.0, 0.0, 0.0), 0.5), ((-1.0, 0.0, 0.0), 0.5)]) is None
    assert nearest_within((1.0, 2.0, 3.0), []) == (1.0, 2.0, 3.0)


OBSTACLES = (
    Box("box", (5.0, 0.0, 2.0), (1.0, 2.0, 4.0), 30.0),
    Cylinder("mast", (0.0, 4.0, 2.0), 0.3, 4.0),
    Sphere("ball", (-3.0, 0.0, 2.0), 0.5),
    Sphere("far", (40.0, 0.0, 2.0), 0.5),
)


@given(st.lists(st.tuples(st.floats(-6, 6), st.floats(-6, 6), st.floats(0.1, 5)), min_size=1, max_size=8))
def test_what_is_near_is_the_same_wherever_one_comes_from(path) -> None:
    surroundings = Surroundings(OBSTACLES, 0.4)
    neighbourhood, candidates = Neighbourhood(surroundings, Shield(floor=0.0)), Candidates()
    world = World(OBSTACLES)
    for point in path:
        candidates, near = neighbourhood.look(candidates, point, (), 2.0)
        gaps = {solid.name: solid.distance(*point) - 0.4 for solid in world.solids}
        expected = {name: gap for name, gap in gaps.items() if gap < 2.0}
        found = {thing.name: thing.gap for thing in near if thing.solid}
        assert {name: gap for name, gap in found.items() if gap < 2.0} == pytest.approx(expected, abs=0.005)
        assert found == pytest.approx({name: gaps[name] for name in found}, abs=0.005)
        if expected:
            assert nearest(near).gap == pytest.approx(min(expected.values()))


def test_floor_ceiling_fence_and_what_the_sensors_see_are_near_too() -> None:
    neighbourhood = Neighbourhood(Surroundings((), 0.5), Shield(floor=0.5, ceiling=5.0, fence=10.0))
    _, low = neighbourhood.look(Candidates(), (9.0, 0.0, 0.8), ((9.0, 2.0, 0.8),), 2.0)
    found = {thing.name: thing for thing in low}
    assert set(found) == {"floor", "fence", "sensor"}
    assert found["floor"] == Near(pytest.approx(0.3), (0.0, 0.0, 1.0), "floor", solid=False)
    assert found["fence"].gap == pytest.approx(0.5)
    assert found["fence"].normal == (-1.0, -0.0, -0.0)
    assert found["sensor"].gap == pytest.approx(1.5)
    assert found["sensor"].normal == pytest.approx((0.0, -1.0, 0.0))
    _, high = neighbourhood.look(Candidates(), (0.0, 0.0, 4.5), (), 2.0)
    assert [thing.name for thing in high] == ["ceiling"]
    assert nearest(high) is None


def test_what_is_seen_of_a_known_obstacle_is_that_obstacle() -> None:
    neighbourhood = Neighbourhood(Surroundings(OBSTACLES, 0.4), Shield(floor=0.0))
    seen = ((-2.4, 0.1, 2.0), (-1.0, -1.5, 2.0))
    candidates, near = neighbourhood.look(Candidates(), (-1.0, 0.0, 2.0), seen, 2.0)
    assert sorted(thing.name for thing in near if thing.solid) == ["ball", "sensor"]
    _, moved = neighbourhood.look(candidates, (-1.2, 0.0, 2.0), seen, 2.0)
    assert sorted(thing.name for thing in moved if thing.solid) == ["ball", "sensor"]


def test_a_mission_s_fence_stands_in_place_of_the_settings() -> None:
    known = Surroundings((), 0.5, fence=Fence(radius=4.0, ceiling=3.0, floor=1.0))
    neighbourhood = Neighbourhood(known, Shield(floor=0.5, ceiling=50.0, fence=100.0))
    _, near = neighbourhood.look(Candidates(), (3.0, 0.0, 2.0), (), 1.5)
    assert {thing.name: thing.gap for thing in near} == pytest.approx(
        {"fence": 0.5, "floor": 1.0, "ceiling": 1.0}
    )


def wall(gap: float, normal=(-1.0, 0.0, 0.0), name: str = "wall") -> Near:
    return Near(gap, normal, name, solid=True)


def situation(*near: Near, velocity=ZERO3, yaw: float = 0.0, push=ZERO3) -> Situation:
    return Situation(near, velocity, yaw, push)


AHEAD = (2.0, 0.0, 0.0, 0.3)


def test_what_leads_nowhere_near_is_not_changed_at_all() -> None:
    assert BARRIER.guard(AHEAD, situation(wall(6.0))) == (AHEAD, "")
    away = (-2.0, 0.0, 0.0, 0.3)
    assert BARRIER.guard(away, situation(wall(0.3))) == (away, "")
    along = (0.0, 2.0, 0.0, 0.0)
    assert BARRIER.guard(along, situation(wall(0.3))) == (along, "")


def test_the_speed_towards_a_wall_is_what_stops_within_the_gap() -> None:
    gap = 1.25
    safe, by = BARRIER.guard(AHEAD, situation(wall(gap)))
    assert by == "wall"
    speed, braking = safe[0], SETTINGS.braking * LIMITS.acceleration
    reaction = 0.02 + LIMITS.acceleration / LIMITS.jerk + COMPENSATED[0].time
    # h = s T + s² / 2a uses up just the gap less the margin.
    assert speed * reaction + speed * speed / (2 * braking) == pytest.approx(gap - SETTINGS.margin)
    assert safe[1:] == (0.0, 0.0, 0.3)


def test_at_an_angle_only_what_leads_into_the_wall_is_taken() -> None:
    safe, _ = BARRIER.guard((1.5, 1.0, 0.2, 0.0), situation(wall(0.4)))
    assert safe[0] < 0.5
    assert safe[1:] == pytest.approx((1.0, 0.2, 0.0))


def test_the_guard_sees_the_wall_on_the_axes_that_the_vehicle_will_have() -> None:
    # It looks north as the setpoint arrives: the wall in the east is to its right.
    safe, _ = BARRIER.guard((1.0, -1.0, 0.0, 0.0), situation(wall(0.25), yaw=pi / 2))
    assert safe == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-9)


def test_in_a_corner_both_walls_hold() -> None:
    corner = (wall(0.25), wall(0.25, (0.0, -1.0, 0.0), "other"))
    safe, _ = BARRIER.guard((1.0, 0.5, 0.3, 0.0), situation(*corner))
    assert safe == pytest.approx((0.0, 0.0, 0.3, 0.0), abs=1e-9)


def test_squeezed_between_two_walls_it_stands() -> None:
    slit = (wall(0.1), wall(0.1, (1.0, 0.0, 0.0), "other"))
    assert BARRIER.guard((1.0, 1.0, 1.0, 0.2), situation(*slit)).velocity == (0.0, 0.0, 0.0, 0.2)


def test_wind_towards_the_wall_and_a_speed_too_high_are_held_against() -> None:
    calm = BARRIER.guard(AHEAD, situation(wall(0.8))).velocity[0]
    windy = BARRIER.guard(AHEAD, situation(wall(0.8), push=(0.5, 0.0, 0.0))).velocity[0]
    offshore = BARRIER.guard(AHEAD, situation(wall(0.8), push=(-0.5, 0.0, 0.0))).velocity[0]
    fast = BARRIER.guard(AHEAD, situation(wall(0.8), velocity=(2.0, 0.0, 0.0))).velocity[0]
    assert windy < calm == offshore
    assert fast < calm - 0.5


def test_within_the_margin_it_is_led_out_slowly_and_the_floor_has_no_margin() -> None:
    inside = BARRIER.guard((0.0, 0.0, 0.0, 0.0), situation(wall(0.05)))
    assert inside.velocity[0] == pytest.approx(-(SETTINGS.margin - 0.05))
    low = Near(0.0, (0.0, 0.0, 1.0), "floor", solid=False)
    assert BARRIER.guard((0.0, 0.0, -1.0, 0.0), situation(low)) == (
        pytest.approx((0.0, 0.0, 0.0, 0.0)),
        "floor",
    )


def test_a_vehicle_that_flies_faster_than_it_is_told_is_told_less() -> None:
    chi = load_airframe("matrice_100").chi
    bare = Barrier(SETTINGS, LIMITS, lags_of(chi)).guard(AHEAD, situation(wall(1.25)))
    assert bare.velocity[0] < 0.5 * BARRIER.guard(AHEAD, situation(wall(1.25))).velocity[0]


things = st.lists(
    st.builds(Near, st.floats(0.25, 8), directions, st.just("thing"), st.just(True)), max_size=5
)


@given(points, things, points, st.floats(-pi, pi))
def test_the_guard_changes_nothing_without_need_and_never_makes_it_faster(
    wanted, near, velocity, yaw
) -> None:
    slow = tuple(0.2 * part for part in velocity)
    safe, by = BARRIER.guard((*wanted, 0.1), situation(*near, velocity=slow, yaw=yaw))
    assert safe[3] == 0.1
    if not by:
        assert safe[:3] == wanted
    # Standing is always safe here, so the nearest safe velocity is no faster than the one wanted.
    still = BARRIER.guard((0.0, 0.0, 0.0, 0.1), situation(*near, velocity=slow, yaw=yaw))
    if not still.by:
        assert hypot(*safe[:3]) <= hypot(*wanted) + 1e-9
    again = BARRIER.guard(safe, situation(*near, velocity=slow, yaw=yaw))
    assert again.velocity[:3] == pytest.approx(safe[:3], abs=2e-3)


@given(st.floats(0, 3), st.floats(0.0, 0.99))
def test_beyond_its_reach_the_barrier_never_acts(speed: float, share: float) -> None:
    gap = BARRIER.reach(speed) + 1e-6
    assert not BARRIER.guard(
        (speed, 0.0, 0.0, 0.0), situation(wall(gap), velocity=(share * speed, 0.0, 0.0))
    ).by


def test_a_risk_field_pushes_more_the_nearer_and_the_faster() -> None:
    field = RiskField(SETTINGS, LIMITS)
    still = [field.guard(AHEAD, situation(wall(gap))).velocity[0] for gap in (2.0, 1.0, 0.6, 0.2)]
    assert still == sorted(still, reverse=True)
    assert still[0] == 2.0
    assert still[-1] == pytest.approx(2.0 - LIMITS.horizontal_speed)
    moving = field.guard(AHEAD, situation(wall(1.0), velocity=(1.0, 0.0, 0.0))).velocity[0]
    assert moving < still[1]


def test_off_is_off() -> None:
    assert Off().guard(AHEAD, situation(wall(0.0))) == (AHEAD, "")


@given(st.floats(0.5, 3), st.floats(0.3, 2.5))
@settings(max_examples=25)
def test_a_vehicle_that_follows_stops_before_the_wall(speed: float, start: float) -> None:
    """In one dimension: what is told is limited in acceleration and jerk, and followed with the lag."""
    from groundstation.pilot.limits import SetpointLimiter, SetpointMotion

    limiter, motion = SetpointLimiter(LIMITS), SetpointMotion()
    gap, v, dt = start + SETTINGS.margin, 0.0, 0.004
    for _ in range(3000):
        safe, _ = BARRIER.guard((speed, 0.0, 0.0, 0.0), situation(wall(gap), velocity=(v, 0.0, 0.0)))
        motion, told = limiter.step(motion, safe, dt)
        v += (told[0] - v) * dt / COMPENSATED[0].time
        gap -= v * dt
        assert gap > 0.9 * SETTINGS.margin
    assert gap == pytest.approx(SETTINGS.margin, abs=0.1)
    assert abs(v) < 0.05
