"""How often is painted: the whole rate where the terminal keeps up, down to 10 Hz where it does not."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.tui.pace import SLOWEST_HZ, PaintPace

PERIOD = 1.0 / 30.0


class Terminal:
    """Takes so long for a frame, and keeps the screen waiting once so much is queued."""

    QUEUE_S = 0.3

    def __init__(self, frame_s: float) -> None:
        self.pace, self.now, self.frame_s = PaintPace(30.0), 0.0, frame_s
        self.painted, self.queued = 0, 0.0

    def turn(self, seconds: float) -> float:
        """Go on for a while; return the frames painted a second."""
        before, began = self.painted, self.now
        while self.now < began + seconds:
            due = self.pace.due(self.now)
            self.painted += due
            self.queued += self.frame_s * due
            passed = PERIOD + max(self.queued - self.QUEUE_S, 0.0)
            self.queued = max(self.queued - passed, 0.0)
            self.now += passed
        return (self.painted - before) / (self.now - began)


def test_a_quick_terminal_is_painted_at_the_whole_rate():
    assert Terminal(0.005).turn(20.0) == pytest.approx(30.0, rel=0.01)


def test_a_slow_terminal_is_painted_less_often_but_never_less_than_the_least():
    slow = Terminal(0.09)
    slow.turn(10.0)
    assert slow.pace.rate == SLOWEST_HZ
    assert slow.turn(5.0) == pytest.approx(SLOWEST_HZ, rel=0.1)
    assert slow.queued <= slow.QUEUE_S


def test_a_terminal_that_recovers_is_painted_at_the_whole_rate_again():
    terminal = Terminal(0.09)
    terminal.turn(10.0)
    terminal.frame_s = 0.005
    terminal.turn(90.0)
    assert terminal.turn(5.0) == pytest.approx(30.0, rel=0.02)


def test_tries_that_fail_become_rarer():
    terminal = Terminal(0.055)
    rates = []
    for _ in range(200):
        terminal.turn(1.0)
        rates.append(terminal.pace.rate)
    tries = [index for index in range(1, 200) if rates[index] > rates[index - 1]]
    gaps = [later - earlier for earlier, later in itertools.pairwise(tries)]
    assert gaps[-1] > 2 * gaps[0]


def test_one_frame_that_is_late_changes_nothing():
    terminal = Terminal(0.005)
    for _ in range(20):
        terminal.turn(1.0)
        terminal.now += 0.4
        assert terminal.pace.rate == 30.0


@given(st.floats(1.0, 120.0), st.lists(st.floats(0.0, 2.0), max_size=200))
def test_the_rate_stays_within_its_bounds_whatever_time_does(fastest, gaps):
    pace, now = PaintPace(fastest), 0.0
    for gap in gaps:
        now += gap
        pace.due(now)
        assert min(SLOWEST_HZ, fastest) <= pace.rate <= fastest
