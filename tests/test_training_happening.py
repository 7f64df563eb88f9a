"""What an instructor or a timetable lets happen: over the bus, in words, and what of it is in force."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.messages import HAPPENING_TEXT
from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)
from groundstation.training.happening import Calm, packed, unpacked, words
from groundstation.training.in_force import STATES, InForce

air = st.tuples(*[st.floats(-20, 20)] * 3)
seconds = st.floats(0.001, 60)
happenings = st.one_of(
    st.builds(WindChange, velocity=air, turbulence=st.floats(0, 10)),
    st.builds(GustNow, velocity=air, duration_s=seconds),
    st.builds(Delay, round_trip_s=st.floats(0, 2), jitter_s=st.floats(0, 1)),
    st.builds(Loss, share=st.floats(0, 0.95)),
    st.builds(LinkLoss, duration_s=seconds),
    st.builds(DeviceLoss, duration_s=seconds),
    st.builds(BatteryLeft, remaining=st.floats(0.001, 1)),
    st.builds(GpsLoss, duration_s=seconds),
    st.just(Calm()),
)


@given(happenings)
def test_everything_crosses_the_bus_as_it_is(happening):
    data = packed(happening)
    assert len(data) < HAPPENING_TEXT
    assert unpacked(data) == happening
    assert words(happening)


@pytest.mark.parametrize(
    "data", [b"", b"{", b"[]", b'{"kind":"kill"}', b'{"kind":"loss","share":2}', b"\xff"]
)
def test_what_cannot_happen_is_nothing(data):
    assert unpacked(data) is None


@pytest.mark.parametrize(
    ("happening", "told"),
    [
        (WindChange(velocity=(3.0, 0.0, 0.0)), "wind 3.0 m/s from the west"),
        (
            WindChange(velocity=(0.0, -2.0, 0.0), turbulence=0.5),
            "wind 2.0 m/s from the north, turbulence 0.5 m/s",
        ),
        (WindChange(velocity=(0.0, 0.0, 0.0)), "no wind"),
        (GustNow(velocity=(-3.0, -3.0, 0.0), duration_s=4.0), "gust 4.2 m/s from the north-east, 4 s long"),
        (GustNow(velocity=(0.0, 0.0, -2.0), duration_s=1.5), "gust 2.0 m/s downward, 1.5 s long"),
        (Delay(round_trip_s=0.3, jitter_s=0.02), "round trip 300 ms ± 20 ms"),
        (Loss(share=0.1), "10 % of frames lost"),
        (BatteryLeft(remaining=0.12), "battery down to 12 %"),
        (GpsLoss(duration_s=5.0), "GPS lost for 5 s"),
    ],
)
def test_words(happening, told):
    assert words(happening) == told


def test_what_is_in_force_changes_with_time_and_the_gravest_stands_first():
    force = InForce()
    assert (force.state(0.0), force.told(0.0)) == ("nothing", "nothing")
    force.take(WindChange(velocity=(3.0, 0.0, 0.0)), 1.0)
    force.take(LinkLoss(duration_s=5.0), 2.0)
    assert force.state(2.5) == "link lost"
    assert force.told(3.0) == "link lost for 5 s (4 s left); wind 3.0 m/s from the west"
    assert force.state(7.0) == "wind"
    force.take(WindChange(velocity=(0.0, 0.0, 0.0)), 8.0)
    assert force.state(8.0) == "nothing"
    force.take(DeviceLoss(duration_s=20.0), 9.0)
    force.take(Loss(share=0.2), 9.0)
    force.take(Calm(), 10.0)
    assert force.state(10.0) == "nothing"


@given(st.lists(st.tuples(happenings, st.floats(0, 100))), st.floats(0, 200))
def test_what_is_in_force_has_always_a_word(done, t):
    force = InForce()
    for happening, at in sorted(done, key=lambda each: each[1]):
        force.take(happening, at)
    assert force.state(t) in {*STATES.values(), "nothing"}
    assert (force.state(t) == "nothing") == (force.told(t) == "nothing")
