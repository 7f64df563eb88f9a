"""The altitude strip's scale."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from groundstation.tui.widgets.altitude import scale_for


def test_the_scale_grows_at_once_and_shrinks_only_when_much_too_large():
    small, large = (4.0, 1.0), (8.0, 2.0)
    assert scale_for(small, [2.0]) == small
    assert scale_for(small, [3.5]) == large
    assert scale_for(large, [3.2]) == large
    assert scale_for(large, [1.0]) == small


@given(
    st.lists(st.floats(allow_nan=True), max_size=3),
    st.sampled_from([(4.0, 1.0), (80.0, 20.0), (1000.0, 200.0)]),
)
def test_the_scale_shows_every_altitude_it_can(altitudes, scale):
    top, step = scale_for(scale, altitudes)
    highest = max((value for value in altitudes if math.isfinite(value)), default=0.0)
    assert top >= min(highest, 1000.0)
    assert 3 <= top / step <= 5
