"""A computer that slept: what its monotonic clock did not count, and what was fresh before it."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.config import Safety
from groundstation.messages import FlightMode, Stream
from groundstation.vehicle.asleep import Sleep, since_boot
from groundstation.vehicle.gate import Gate
from groundstation.vehicle.offboard import Act, OffboardStream, Seen


class Computer:
    """Two clocks that agree until it sleeps."""

    def __init__(self):
        self.awake = 100.0
        self.asleep = 7.0
        self.sleep = Sleep(lambda: self.awake, lambda: self.awake + self.asleep)


def test_a_sleep_is_told_once_with_its_length():
    computer = Computer()
    computer.awake += 10.0
    assert computer.sleep.news() == 0.0
    computer.asleep += 3600.0
    assert computer.sleep.news() == pytest.approx(3600.0)
    assert computer.sleep.news() == 0.0
    assert computer.sleep.clock() == pytest.approx(110.0 + 3600.0)


@given(st.lists(st.floats(-1.0, 0.02), max_size=30))
def test_two_readings_that_are_held_up_between_are_no_sleep(gaps):
    computer = Computer()
    for gap in gaps:
        computer.asleep = 7.0 + gap
        assert computer.sleep.news() == 0.0


def test_this_machine_has_both_clocks():
    assert since_boot() >= time.monotonic() - 0.1
    assert Sleep().news() == 0.0


def test_what_was_authorised_before_a_sleep_does_not_pass_after_it():
    from test_vehicle_gate import VELOCITY, setpoint

    computer = Computer()
    gate = Gate(0.15, computer.sleep.clock)
    gate.address(1, frozenset())
    made_t = computer.awake
    assert gate.authorise(VELOCITY, made_t + computer.sleep.seconds())
    frame = setpoint()
    assert gate.passes(frame)
    computer.asleep += 2.0
    assert not gate.passes(frame)


def test_a_stream_ends_with_a_hold_and_only_one_that_streams():
    stream = OffboardStream(Safety())
    assert stream.interrupted("it slept") == (Act.NOTHING, "")
    stream.step(Seen(10.0, True, 0.01, FlightMode.HOLD, 0.0))
    assert stream.interrupted("it slept") == (Act.CLOSE_AND_HOLD, "it slept")
    assert stream.state is Stream.ENDED
    # A setpoint that still asks to be flown does not begin it again.
    assert stream.step(Seen(10.1, True, 0.01, FlightMode.HOLD, 0.0)) == (Act.NOTHING, "")
