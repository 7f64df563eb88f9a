"""What a pilot can do, what is open to them and what comes next, from what they flew."""

from __future__ import annotations

import datetime

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.progress.certificate import certificate_of
from groundstation.progress.flown import Flown
from groundstation.progress.overview import table
from groundstation.progress.schedule import WAITS, repetition_of
from groundstation.progress.skills import NOT_PASSED, STUCK, WEIGHT, standing_of
from groundstation.training.curriculum import lessons
from groundstation.training.mission import Mission, Target

TODAY = datetime.date(2026, 11, 26)
DAY = datetime.timedelta(days=1)


def mission(name: str, *skills: str, needs: tuple[str, ...] = ()) -> Mission:
    return Mission(1, name, name.title(), skills=skills, needs=needs, target=Target((1.0, 0.0, 2.0)))


COURSE = (
    mission("hover", "hover"),
    mission("box", "path", needs=("hover",)),
    mission("pad", "landing", "hover", needs=("hover",)),
    mission("ride", "emergency", "landing", needs=("box", "pad")),
    Mission(1, "free", "Free flight"),
)


def flown(name: str, points: float = 80.0, *, passed: bool = True, ago: int = 0) -> Flown:
    started = f"{TODAY - ago * DAY}T10:00:00+00:00"
    return Flown("ann", name, "d", started, passed=passed, points=points)


def after(*flights: Flown):
    return standing_of(COURSE, flights, TODAY)


def test_who_begins_begins_with_the_first():
    standing = after()
    assert standing.next == ("hover", "the first of all")
    assert standing.weakest is None
    assert [name for name, record in standing.records.items() if record.open] == ["hover"]
    assert "free" not in standing.records


def test_what_was_not_passed_is_flown_again_and_what_was_opens_the_next():
    assert after(flown("hover", passed=False)).next.mission == "hover"
    standing = after(flown("hover"))
    assert standing.next == ("box", "new; hover passed")
    assert standing.records["ride"].missing == ("box", "pad")
    assert not standing.records["ride"].open


def test_what_was_flown_before_its_time_stays_open():
    """Locked is advice: an instructor may have let them fly it."""
    assert after(flown("ride")).records["ride"].open


def test_a_level_follows_the_latest_flights_and_a_failure_counts_less():
    levels = after(flown("hover", 50.0), flown("hover", 100.0), flown("pad", 60.0, passed=False)).levels
    assert levels["landing"] == pytest.approx(NOT_PASSED * 60.0)
    hover = 50.0 + WEIGHT * 50.0
    assert levels["hover"] == pytest.approx(hover + WEIGHT * (NOT_PASSED * 60.0 - hover))


def test_of_what_is_due_the_weakest_skill_comes_first():
    standing = after(flown("hover", 90.0, ago=9), flown("box", 60.0, ago=9), flown("pad", 80.0, ago=9))
    assert standing.next.mission == "box"
    assert standing.next.why == "due for 8 days; your weakest in it is path, 60 of 100"
    assert standing.weakest == "path"


def test_after_a_repetition_something_new_is_offered_even_if_more_is_due():
    before = (flown("hover", 90.0, ago=9), flown("box", 60.0, ago=9))
    assert after(*before).next.mission == "box"
    assert after(*before, flown("box", 80.0)).next.mission == "pad"


def test_who_is_stuck_goes_back_to_what_it_builds_on_and_then_tries_again():
    known = (flown("hover", ago=1), flown("box"), flown("pad", 65.0))
    failed = [flown("ride", 20.0, passed=False)] * STUCK
    assert after(*known, *failed[1:]).next.mission == "ride"
    # Hover is due today, and comes first.
    again = (*known, flown("hover"))
    standing = after(*again, *failed)
    assert standing.next == ("pad", "ride failed 3 times, and builds on it")
    assert after(*again, *failed, flown("pad", 90.0)).next.mission == "ride"


def test_when_all_is_passed_and_nothing_due_the_weakest_is_offered():
    standing = after(
        *(
            flown(name, points)
            for name, points in (("hover", 90.0), ("box", 71.0), ("pad", 90.0), ("ride", 95.0))
        )
    )
    assert standing.next.mission == "box"
    assert standing.passed == 4


def test_waits_grow_with_each_day_it_is_flown_well_and_a_failure_begins_anew():
    flights = [flown("hover", ago=100 - day) for day in (0, 0, 1, 4, 11, 25)]
    boxes = [repetition_of(flights[: n + 1]) for n in range(len(flights))]
    assert [each.box for each in boxes] == [0, 0, 1, 2, 3, 4]
    assert [(each.due - flight.day).days for each, flight in zip(boxes, flights, strict=True)] == [
        WAITS[each.box] for each in boxes
    ]
    failed = repetition_of([*flights, flown("hover", passed=False, ago=3)])
    assert failed == (0, TODAY - 3 * DAY)
    poor = repetition_of([flown("hover", ago=9), flown("hover", 40.0, ago=5)])
    assert poor.box == 0
    assert repetition_of([flown("hover", passed=False)]) is None


def flights(names):
    return st.lists(
        st.builds(
            flown,
            st.sampled_from(names),
            st.floats(0.0, 100.0),
            passed=st.booleans(),
            ago=st.integers(0, 60),
        ),
        max_size=30,
    ).map(lambda many: sorted(many, key=lambda each: each.started))


@given(flights([mission.name for mission in COURSE]))
def test_there_is_always_something_to_fly_that_is_open(history):
    standing = after(*history)
    record = standing.records[standing.next.mission]
    assert record.open
    assert standing.next.why
    assert all(0.0 <= level <= 100.0 for level in standing.levels.values())


@given(flights([mission.name for mission in COURSE]), st.sampled_from(COURSE))
def test_a_pass_never_locks_anything(history, one):
    opened = {name for name, record in after(*history).records.items() if record.open}
    later = after(*history, flown(one.name))
    assert opened <= {name for name, record in later.records.items() if record.open}


def test_the_shipped_curriculum_is_learned_to_its_end_by_following_the_advice():
    course = [lesson.mission for lesson in lessons()]
    history: list[Flown] = []
    judged = {mission.name for mission in course if mission.judged}
    for _ in range(len(judged)):
        advice = standing_of(course, history, TODAY).next
        history.append(flown(advice.mission))
    assert {each.mission for each in history} == judged


def test_what_an_instructor_had_a_hand_in_is_practice_and_decides_nothing():
    practice = msgspec.structs.replace(flown("hover", 99.0), instructed=True)
    failed = msgspec.structs.replace(flown("hover", 5.0, passed=False), instructed=True)
    standing = after(practice)
    assert standing.next == ("hover", "the first of all")
    assert (standing.levels, standing.passed) == ({}, 0)
    assert (standing.records["hover"].flights, standing.records["hover"].instructed) == (1, 1)
    # Nor does it spoil what was passed alone.
    alone, both = after(flown("hover")), after(flown("hover"), failed)
    assert both.levels == alone.levels
    assert both.records["hover"].repetition == alone.records["hover"].repetition
    text = table("ann", both, [flown("hover"), failed], TODAY)
    assert "2 (1i)" in text
    assert "an instructor let something happen" in text
    assert "(1i)" not in table("ann", alone, [flown("hover")], TODAY)


def test_the_certificate_tells_what_was_practice_and_passes_nothing_by_it():
    practice = msgspec.structs.replace(flown("hover", 99.0), instructed=True)
    report = certificate_of([practice], COURSE, TODAY)
    found = {finding.what: finding.found for finding in report.findings}
    assert found["missions passed"].startswith("0 of")
    assert found["of them with an instructor's doing, as practice"] == "1"
    assert report.tables[0].rows == []
