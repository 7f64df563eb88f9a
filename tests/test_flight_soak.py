"""The short forms of the long benches: the whole program with random faults, and a link connected again and again.

What they can show in five minutes: nothing dies, nothing stays uncoupled, no descriptor is lost, and no memory runs
away; `python -m bench soak reconnect` shows the rest.
"""

from __future__ import annotations

import contextlib

import pytest

from bench import gauges, reconnect, soak

pytestmark = [pytest.mark.flight, pytest.mark.timeout(600)]

# Five minutes are still a beginning, MB: pages are looked at for the first time, pools and tracks fill. A topic that
# is first sent on in flight, such as the points that a landing cost, opens a connection of two or three descriptors.
STARTING_MB, STARTING_DESCRIPTORS = 5.0, 3


def test_random_faults_kill_nothing_and_let_nothing_run_away():
    course = soak.soak(soak.SHORT_S, seed=1)
    with contextlib.closing(course):
        while True:
            try:
                next(course)
            except StopIteration as end:
                result = end.value
                break
    print(*result.table(), sep="\n")
    assert result.faults.total() > 20
    assert (list(result.dead), result.uncoupled) == ([], 0)
    assert result.kept >= soak.TICKS_BAR
    for role, growth in result.grown.items():
        assert growth.memory < STARTING_MB, role
        assert growth.descriptors <= STARTING_DESCRIPTORS, role


@pytest.mark.parametrize("way", [reconnect.tcp, reconnect.serial, reconnect.udp])
def test_a_link_connected_and_cut_off_again_and_again_keeps_nothing(way):
    readings = reconnect.cycles(way, 20)[5:]
    grown = gauges.growth(readings, share=0.5)
    print(grown)
    # What is read in the moment of a cut has the old way's descriptors and the new one's; the fewest have not.
    early, late = readings[: len(readings) // 2], readings[len(readings) // 2 :]
    assert min(each.descriptors for each in late) <= min(each.descriptors for each in early)
    assert grown.memory < 1.0
