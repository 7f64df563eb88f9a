"""The short forms of the long benches: the whole program with random faults, and a link connected again and again.

Together they take CI two and a half minutes. What they can show in that time: nothing dies, nothing stays uncoupled,
no descriptor is lost, and no memory runs away; `python -m bench soak reconnect` shows the rest.
"""

from __future__ import annotations

import contextlib

import pytest

from bench import gauges, reconnect, soak

pytestmark = [pytest.mark.flight, pytest.mark.timeout(400)]

# The first two minutes: pages that are looked at for the first time, a store that is opened, tracks that fill.
STARTING_MB, STARTING_DESCRIPTORS = 30.0, 8


def test_random_faults_kill_nothing_and_let_nothing_run_away():
    course = soak.soak(120.0, seed=1)
    with contextlib.closing(course):
        while True:
            try:
                next(course)
            except StopIteration as end:
                result = end.value
                break
    print(*result.table(), sep="\n")
    assert result.faults.total() > 8
    assert (list(result.dead), result.uncoupled) == ([], 0)
    assert result.kept >= soak.TICKS_BAR
    for role, growth in result.grown.items():
        assert growth.memory < STARTING_MB, role
        assert growth.descriptors <= STARTING_DESCRIPTORS, role


def test_a_link_connected_and_cut_off_again_and_again_keeps_nothing():
    readings = reconnect.cycles(20)
    # What is read in the moment of a cut has the old socket and the new one: the middle of half of them has not.
    grown = gauges.growth(readings[5:], share=0.5)
    print(grown)
    assert grown.descriptors <= 0
    assert grown.memory < 1.0
