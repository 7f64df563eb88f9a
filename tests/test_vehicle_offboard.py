"""The stream's state machine, row by row: what starts it, what ends it, and that nothing resumes by itself."""

import math

import pytest

from groundstation.config import Safety
from groundstation.messages import FlightMode, Stream
from groundstation.vehicle.offboard import Act, OffboardStream, Seen


def seen(now=10.0, active=True, age=0.01, mode=FlightMode.HOLD, mode_t=0.0):
    return Seen(now, active, age, mode, mode_t)


@pytest.fixture
def stream():
    return OffboardStream(Safety())


@pytest.fixture
def flying(stream):
    assert stream.step(seen(9.7)) == (Act.NOTHING, "")
    assert stream.step(seen(10.0)) == (Act.START, "")
    stream.accepted(10.1)
    stream.step(seen(10.5, mode=FlightMode.OFFBOARD, mode_t=10.4))
    assert stream.state is Stream.FLYING
    return stream


def test_nothing_starts_without_an_active_fresh_setpoint(stream):
    for idle in (seen(active=False), seen(age=0.2), seen(age=math.inf)):
        assert stream.step(idle) == (Act.NOTHING, "")
        assert stream.state is Stream.IDLE


def test_setpoints_stream_for_a_moment_before_offboard_is_asked_for_and_it_is_asked_once(stream):
    acts = []
    for n in range(40):
        act, _ = stream.step(seen(10.0 + 0.01 * n))
        assert stream.state is Stream.STARTING
        acts.append(act)
    assert acts.index(Act.START) == pytest.approx(20, abs=1)
    assert acts.count(Act.START) == 1
    assert set(acts) == {Act.NOTHING, Act.START}


def test_letting_go_before_offboard_was_asked_for_holds(stream):
    stream.step(seen(10.0))
    assert stream.step(seen(10.1, active=False)) == (Act.CLOSE_AND_HOLD, "")
    assert stream.step(seen(10.2, active=False)) == (Act.NOTHING, "")
    assert stream.step(seen(10.3)) == (Act.NOTHING, "")
    assert stream.step(seen(10.6)) == (Act.START, "")


def test_a_heartbeat_from_before_the_acknowledgement_proves_nothing(stream):
    stream.step(seen(9.7))
    stream.step(seen(10.0))
    stream.step(seen(10.05, mode=FlightMode.OFFBOARD, mode_t=9.9))
    assert stream.state is Stream.STARTING
    stream.accepted(10.1)
    stream.step(seen(10.2, mode=FlightMode.OFFBOARD, mode_t=9.9))
    assert stream.state is Stream.STARTING
    stream.step(seen(10.6, mode=FlightMode.OFFBOARD, mode_t=10.5))
    assert stream.state is Stream.FLYING


def test_a_start_that_is_not_confirmed_ends_in_hold(stream):
    stream.step(seen(10.0))
    stream.step(seen(10.3))
    act, why = stream.step(seen(13.1))
    assert act is Act.CLOSE_AND_HOLD
    assert "did not confirm" in why


def test_a_refusal_ends_it_without_hold(stream):
    stream.step(seen())
    act, why = stream.refused("no setpoints")
    assert act is Act.CLOSE
    assert "no setpoints" in why
    assert stream.state is Stream.ENDED


def test_a_vehicle_that_does_not_answer_may_be_in_offboard_and_is_told_to_hold(stream):
    stream.step(seen())
    act, why = stream.unanswered()
    assert act is Act.CLOSE_AND_HOLD
    assert "did not answer" in why
    assert stream.state is Stream.ENDED


def test_letting_go_holds(flying):
    assert flying.step(seen(11.0, active=False, mode=FlightMode.OFFBOARD, mode_t=10.9)) == (
        Act.CLOSE_AND_HOLD,
        "",
    )


def test_a_silent_pilot_ends_in_hold(flying):
    act, why = flying.step(seen(11.0, age=0.16, mode=FlightMode.OFFBOARD, mode_t=10.9))
    assert act is Act.CLOSE_AND_HOLD
    assert "silent" in why


def test_a_mode_changed_by_others_is_not_fought(flying):
    act, why = flying.step(seen(11.0, mode=FlightMode.POSITION, mode_t=10.9))
    assert act is Act.CLOSE
    assert "POSITION" in why


def test_an_own_command_makes_room_without_hold(flying):
    flying.end()
    assert flying.step(seen(11.0, active=False)) == (Act.NOTHING, "")


def test_what_has_ended_resumes_only_after_a_fresh_act(flying):
    flying.step(seen(11.0, age=0.2, mode=FlightMode.OFFBOARD, mode_t=10.9))
    assert flying.step(seen(11.1)) == (Act.NOTHING, "")
    assert flying.state is Stream.ENDED
    flying.step(seen(11.2, active=False))
    assert flying.state is Stream.IDLE
    assert flying.step(seen(11.3)) == (Act.NOTHING, "")
    assert flying.step(seen(11.6))[0] is Act.START
