"""The missions that come with the program: complete, in order, and each of them can be flown by hand."""

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.checking import clearance, faults, misplaced
from groundstation.training.curriculum import circle, depth, lessons
from groundstation.training.mission import (
    Criteria,
    Fence,
    Landing,
    Mission,
    Skill,
    Target,
    Waypoint,
)
from sim.airframe import load_airframe
from sim.scenario import Gate, Gust, Pad, Sphere, Wind

LESSONS = lessons()
KNOWN = {lesson.mission.name: lesson.mission for lesson in LESSONS}
JUDGED = [mission for mission in KNOWN.values() if mission.judged]
X500 = load_airframe("x500")


@pytest.mark.parametrize("mission", KNOWN.values(), ids=lambda mission: mission.name)
def test_every_mission_can_be_flown_and_is_not_flown_by_itself(mission):
    airframe = load_airframe(mission.vehicle.airframe)
    assert faults(mission, airframe) == []
    assert misplaced(mission, KNOWN) == []


@pytest.mark.parametrize("mission", JUDGED, ids=lambda mission: mission.name)
def test_every_exercise_says_what_it_is_for(mission):
    assert mission.teaches.endswith(".")
    assert 2 <= len(mission.watch) <= 4
    assert mission.skills
    if mission.name != "paper":  # its route is the paper's, and so are its bare points
        for point in mission.waypoints:
            assert point.say.endswith(".")
            # The map at 80 columns shows so much of it.
            assert len(point.say.partition(". ")[0]) <= 33


def test_the_curriculum_is_whole():
    assert KNOWN.keys() >= {
        "spring", "hover", "axes", "yaw", "box", "waypoints", "eight", "landing", "slalom", "gates", "corridor",
        "tower", "wind", "gusts", "delay-100", "delay-300", "delay-600", "packet-loss", "device-loss",
        "link-loss", "battery", "paper", "check-ride",
    }  # fmt: skip
    trained = {skill for mission in JUDGED for skill in mission.skills}
    assert trained == set(msgspec.inspect.type_info(Skill).values)


def test_what_a_mission_needs_comes_before_it_and_free_flight_comes_last():
    order = [lesson.mission.name for lesson in LESSONS]
    for name, mission in KNOWN.items():
        assert all(order.index(needed) < order.index(name) for needed in mission.needs)
    assert order[0] == "spring"
    assert set(order[-2:]) == {"calm", "free"}
    assert order[: len(JUDGED)] == [mission.name for mission in JUDGED]


names = st.sampled_from("abcdef")


@given(st.dictionaries(names, st.lists(names, max_size=3)))
def test_depth_and_circles_of_any_needs_come_to_an_end(needs):
    for name in needs:
        assert 0 <= depth(name, needs) <= len(needs)
        if not any(circle(each, needs) for each in needs):
            assert all(depth(name, needs) > depth(other, needs) for other in needs[name] if other in needs)


def mission(**fields) -> Mission:
    return Mission(schema=1, name="m", title="t", **fields)


AHEAD = Target((6.0, 0.0, 2.0))
BALL = Sphere("ball", (3.0, 0.9, 2.0), 0.3)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (mission(target=AHEAD, obstacle=(BALL,)), "comes to 0.60 m of 'ball'"),
        (mission(target=AHEAD, obstacle=(Sphere("ball", (6.0, 0.0, 2.0), 0.3),)), "comes to 0.00 m"),
        (
            mission(target=AHEAD, obstacle=(Sphere("ball", (6.0, 0.0, 0.3), 0.3),)),
            "comes to 0.00 m of 'ball'",
        ),
        (mission(target=AHEAD, obstacle=(Gate("g", (3.0, 3.0, 2.0), 2.0, 2.0),)), "through gate 'g'"),
        (mission(target=AHEAD, fence=Fence(radius=6.2)), "[6, 0, 2] is not inside the fence"),
        (mission(target=AHEAD, fence=Fence(ceiling=1.5)), "above the ceiling of 1.5 m"),
        (mission(target=Target((6.0, 0.0, 0.3))), "below the guard's floor"),
        (mission(target=AHEAD, criteria=Criteria(time_limit_s=5.0)), "give more"),
        (mission(target=AHEAD, criteria=Criteria(final_error_m=0.5)), "can never be missed"),
        (mission(target=AHEAD, wind=Wind(mean=(9.0, 9.0, 0.0))), "12.7 m/s"),
        (mission(target=AHEAD, wind=Wind(gust=(Gust(1.0, 1.0, (0.0, 13.0, 0.0)),))), "13.0 m/s"),
        (mission(target=Target((0.0, 0.0, 2.0))), "does nothing"),
        (mission(route=(Waypoint((0.5, 0.0, 2.0), hold_s=4.0),)), "does nothing"),
        (mission(landing=Landing("p"), pad=(Pad("p", (0.3, 0.0, 0.0)),)), "does nothing"),
    ],
)
def test_what_cannot_be_flown_is_told(wrong, said):
    found = faults(wrong, X500)
    assert any(said in sentence for sentence in found), found
    assert all(sentence.endswith(".") for sentence in found)


def test_a_mission_that_is_right_has_no_faults():
    assert (
        faults(mission(target=AHEAD, obstacle=(msgspec.structs.replace(BALL, center=(3.0, 2.0, 2.0)),)), X500)
        == []
    )
    assert faults(mission(target=Target((0.0, 0.0, 2.0), yaw_deg=90.0)), X500) == []


def test_needs_that_lead_nowhere_or_round_are_told():
    one, other = mission(needs=("other",)), msgspec.structs.replace(mission(), name="other", needs=("m",))
    assert any("leads back" in sentence for sentence in misplaced(one, {"other": other}))
    assert any("no mission 'gone'" in sentence for sentence in misplaced(mission(needs=("gone",)), {}))
    hard = msgspec.structs.replace(mission(), name="hard", level=4)
    assert any("level 4" in sentence for sentence in misplaced(mission(needs=("hard",)), {"hard": hard}))


@given(st.floats(-3.0, 9.0), st.floats(-3.0, 3.0))
def test_clearance_is_that_of_the_nearest_point_of_the_way(x, y):
    ball = Sphere("ball", (x, y, 2.0), 0.2)
    nearest = min(max(x, 0.0), 6.0)
    assert clearance(mission(target=AHEAD, obstacle=(ball,))) == pytest.approx(
        ((x - nearest) ** 2 + y**2) ** 0.5 - 0.2, abs=0.011
    )


def test_a_pad_under_the_last_point_adds_no_climb():
    pad = Pad("p", (6.0, 0.0, 0.0))
    low = mission(route=((6.0, 0.2, 1.0),), landing=Landing("p"), pad=(pad,))
    assert low.way == ((6.0, 0.2, 1.0),)
    assert mission(landing=Landing("p"), pad=(pad,)).way == ((6.0, 0.0, 2.0),)
