"""What piled up is recorded in parts: nothing is lost, none is long, and each is of its own time."""

from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st
from recording_support import a_handle, a_pilot_state

from groundstation.messages import HANDLE, PILOT_STATE
from groundstation.recording.batch import TOPICS, Batch

LONGEST = 1.0
times = st.lists(st.floats(0.0, 6.0), max_size=30).map(sorted)


@given(times, times)
def test_a_batch_is_parted_by_time_and_whole_in_its_parts(handles, states):
    batch = Batch()
    batch.add(HANDLE, [a_handle(t, i) for i, t in enumerate(handles)])
    batch.add(PILOT_STATE, [a_pilot_state(t) for t in states])
    parts = list(batch.parts(LONGEST))
    for topic in TOPICS:
        assert [record for part in parts for record in part.of(topic)] == batch.of(topic)
    spans = [[record.t for topic in TOPICS for record in part.of(topic)] for part in parts]
    assert all(max(span) - min(span) <= LONGEST for span in spans if span)
    assert all(max(one) < min(other) for one, other in itertools.pairwise(spans))


def test_one_that_is_short_is_taken_as_it_is():
    batch = Batch()
    batch.add(HANDLE, [a_handle(5.0 + 1e-3 * i, i) for i in range(800)])
    assert list(batch.parts(LONGEST)) == [batch]
    assert next(iter(Batch().parts(LONGEST))).of(HANDLE) == []
