import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.clock import Every, Pacer
from groundstation.pilot.lateness import Lateness


class VirtualTime:
    """A clock that sleeping moves, by as much as asked and a given excess; each look takes a nanosecond."""

    def __init__(self) -> None:
        self.now = 100.0
        self.excess = 0.0
        self.slept: list[float] = []

    def clock(self) -> float:
        self.now += 1e-9
        return self.now

    def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)
        self.now += seconds + self.excess


def test_deadlines_are_absolute_so_lateness_does_not_add_up() -> None:
    time = VirtualTime()
    pacer = Pacer(0.001, time.clock, time.sleep)
    time.excess = 0.0003
    lateness = [pacer.wait() for _ in range(1000)]
    assert all(late == pytest.approx(0.0003, abs=1e-7) for late in lateness)
    assert time.now == pytest.approx(101.0003, abs=1e-6)
    assert pacer.missed == 0


def test_the_last_stretch_is_waited_for_awake() -> None:
    time = VirtualTime()
    pacer = Pacer(0.001, time.clock, time.sleep, spin=0.0001)
    time.excess = 0.00005
    assert pacer.wait() == pytest.approx(0.0, abs=1e-7)
    assert time.slept == [pytest.approx(0.0009, abs=1e-7)]


def test_a_tick_late_by_less_than_a_period_is_caught_up_with() -> None:
    time = VirtualTime()
    pacer = Pacer(0.001, time.clock, time.sleep)
    pacer.wait()
    time.now += 0.0018
    assert pacer.wait() == pytest.approx(0.0008, abs=1e-6)
    assert pacer.missed == 0
    assert pacer.elapsed == 0.001
    assert pacer.wait() == pytest.approx(0.0, abs=1e-6)


def test_deadlines_long_past_are_counted_not_run() -> None:
    time = VirtualTime()
    pacer = Pacer(0.001, time.clock, time.sleep)
    pacer.wait()
    time.now += 0.0104
    late = pacer.wait()
    assert pacer.missed == 9
    assert pacer.elapsed == pytest.approx(0.010)
    assert late == pytest.approx(0.0004, abs=1e-6)
    pacer.restart(0.01)
    pacer.wait()
    assert pacer.missed == 9
    assert pacer.elapsed == 0.01


@given(st.lists(st.floats(0, 0.02), min_size=1, max_size=200))
def test_ticks_and_missed_ones_together_are_the_time_that_passed(work: list[float]) -> None:
    time = VirtualTime()
    pacer = Pacer(0.001, time.clock, time.sleep)
    start, elapsed = time.now, 0.0
    for seconds in work:
        assert 0.0 <= pacer.wait() < 0.001 + 1e-6
        elapsed += pacer.elapsed
        assert time.now - start == pytest.approx(elapsed, abs=0.001 + 1e-6)
        time.now += seconds


def test_every_is_due_once_a_period_and_does_not_make_up_for_a_pause() -> None:
    every = Every(0.02)
    due = [t for t in range(100) if every.due(t * 0.001 + 0.0001)]
    assert due == [0, 20, 40, 60, 80]
    assert every.due(5.0)
    assert not every.due(5.019)
    assert every.due(5.0201)


def test_lateness_gives_order_statistics_of_the_latest_and_begins_anew() -> None:
    late = Lateness(1000)
    for value in range(100, 0, -1):
        late.add(value * 1e-3)
    assert late.report()[:3] == pytest.approx((0.050, 0.100, 0.100))
    assert late.report() == (0.0, 0.0, 0.0, 0.0, 0.0)
    late.add(0.002)
    assert late.report()[:3] == (0.002, 0.002, 0.002)


def test_full_lateness_keeps_the_latest() -> None:
    late = Lateness(3)
    for value in (9.0, 1.0, 2.0, 3.0):
        late.add(value)
    assert late.report()[:3] == (2.0, 3.0, 3.0)


def test_lateness_since_the_start_outlives_the_reports() -> None:
    late = Lateness(10)
    for value in range(1000):
        late.add(value * 1e-6)
        if value % 7 == 0:
            late.report()
    figures = late.report()
    assert figures.run_p50 == pytest.approx(500e-6, abs=6e-6)
    assert figures.run_p99 == pytest.approx(990e-6, abs=6e-6)


def test_lateness_beyond_the_bins_counts_as_the_last() -> None:
    late = Lateness(10)
    late.add(3.0)
    assert late.report().run_p99 == pytest.approx(0.02)
