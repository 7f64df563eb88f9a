"""A mission's timetable: every event once, at its time or after its point."""

from hypothesis import given
from hypothesis import strategies as st

from groundstation.training.events import Delay, LinkLoss, Timetable, WindChange

CALM_THEN_DELAY = (
    WindChange(velocity=(1.0, 0.0, 0.0)),
    Delay(at_s=5.0, round_trip_s=0.3),
    LinkLoss(leg=2, at_s=1.0, duration_s=4.0),
)


def test_an_event_happens_at_its_time_and_once():
    table = Timetable(CALM_THEN_DELAY)
    assert [type(event) for event in table.due(0.0, 0)] == [WindChange]
    assert table.due(4.9, 0) == []
    assert [type(event) for event in table.due(5.1, 0)] == [Delay]
    assert table.due(60.0, 1) == []


def test_with_a_leg_it_counts_from_when_the_point_was_reached():
    table = Timetable(CALM_THEN_DELAY)
    table.due(10.0, 1)
    assert table.due(12.0, 2) == []
    assert table.due(12.9, 2) == []
    assert [type(event) for event in table.due(13.0, 2)] == [LinkLoss]


@given(st.lists(st.tuples(st.floats(0.01, 5.0), st.booleans()), max_size=40))
def test_every_event_happens_exactly_once_however_time_and_points_go_on(steps):
    table, elapsed, leg, happened = Timetable(CALM_THEN_DELAY), 0.0, 0, []
    for step, on in steps:
        elapsed += step
        leg = min(leg + on, 2)
        happened += table.due(elapsed, leg)
    happened += table.due(elapsed, 2) + table.due(elapsed + 60.0, 2)
    assert sorted(happened, key=CALM_THEN_DELAY.index) == list(CALM_THEN_DELAY)
