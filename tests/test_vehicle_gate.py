"""The gate lets out nothing that steers but a fresh, authorised body velocity."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink

from groundstation.vehicle.gate import Gate, message_number, split_frames

VELOCITY = (1.0, 0.5, -0.25, 0.1)
MASK = 1479


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def gate(clock):
    gate = Gate(0.15, clock)
    gate.address(1, frozenset())
    return gate


def packer():
    return mavlink.MAVLink(None, srcSystem=255, srcComponent=190)


def setpoint(velocity=VELOCITY, mask=MASK, frame=8, position=0.0, system=1) -> bytes:
    forward, left, up, yaw_rate = velocity
    return (
        packer()
        .set_position_target_local_ned_encode(
            1, system, 1, frame, mask, position, 0, 0, forward, -left, -up, 0, 0, 0, 0, -yaw_rate
        )
        .pack(packer())
    )


def test_an_authorised_setpoint_passes_while_it_is_young(gate, clock):
    assert gate.authorise(VELOCITY, clock.now)
    assert gate.passes(setpoint())
    clock.now += 0.149
    assert gate.passes(setpoint())
    clock.now += 0.002
    assert not gate.passes(setpoint())
    assert (gate.sent, gate.dropped) == (2, 1)


def test_age_counts_from_when_the_setpoint_was_made(gate, clock):
    assert gate.authorise(VELOCITY, clock.now - 0.1)
    clock.now += 0.06
    assert not gate.passes(setpoint())


def test_a_stale_or_not_finite_setpoint_is_never_authorised(gate, clock):
    assert not gate.authorise(VELOCITY, clock.now - 0.2)
    for bad in (math.nan, math.inf, -math.inf):
        assert not gate.authorise((0.0, bad, 0.0, 0.0), clock.now)
    assert not gate.passes(setpoint())


def test_another_velocity_does_not_pass(gate, clock):
    gate.authorise(VELOCITY, clock.now)
    assert not gate.passes(setpoint((1.0, 0.5, -0.25, 0.2)))
    assert not gate.passes(setpoint((1.001, 0.5, -0.25, 0.1)))


def test_a_closed_gate_lets_nothing_steer_until_authorised_again(gate, clock):
    gate.authorise(VELOCITY, clock.now)
    gate.close()
    assert not gate.passes(setpoint())
    gate.authorise(VELOCITY, clock.now)
    assert gate.passes(setpoint())


@pytest.mark.parametrize(("mask", "frame"), [(1479, 1), (0, 8), (1478, 8), (3527, 8)])
def test_other_frames_and_masks_do_not_pass(gate, clock, mask, frame):
    gate.authorise(VELOCITY, clock.now)
    assert not gate.passes(setpoint(mask=mask, frame=frame))


@pytest.mark.parametrize("system", [0, 2, 255])
def test_a_setpoint_for_another_vehicle_or_for_all_does_not_pass(gate, clock, system):
    gate.authorise(VELOCITY, clock.now)
    assert not gate.passes(setpoint(system=system))


def test_a_zero_setpoint_passes_though_mavlink_cuts_its_zeros(gate, clock):
    gate.authorise((0.0, 0.0, 0.0, 0.0), clock.now)
    assert gate.passes(setpoint((0.0, 0.0, 0.0, 0.0)))


def test_other_messages_pass_and_other_ways_to_steer_do_not(gate):
    link = packer()
    assert gate.passes(link.heartbeat_encode(6, 8, 0, 0, 4).pack(link))
    attitude = link.set_attitude_target_encode(0, 1, 1, 0, [1, 0, 0, 0], 0, 0, 0, 0.5)
    manual = link.manual_control_encode(1, 0, 0, 500, 0, 0)
    assert not gate.passes(attitude.pack(link))
    assert not gate.passes(manual.pack(link))
    assert gate.dropped == 2


@given(st.tuples(*[st.floats(-20, 20, width=32)] * 4))
def test_every_finite_velocity_survives_the_wire_format(velocity):
    gate = Gate(0.15, lambda: 5.0)
    gate.address(1, frozenset())
    assert gate.authorise(velocity, 5.0)
    assert gate.passes(setpoint(velocity))


@given(st.binary(max_size=80))
def test_any_bytes_get_an_answer(data):
    Gate(0.15, lambda: 0.0).passes(data)
    message_number(data)


def test_frames_are_cut_where_they_end():
    link = packer()
    first, second = link.heartbeat_encode(6, 8, 0, 0, 4).pack(link), setpoint()
    assert split_frames(bytes(first) + bytes(second)) == [bytes(first), bytes(second)]
    assert [message_number(frame) for frame in split_frames(bytes(first) + bytes(second))] == [0, 84]


def test_a_frame_with_something_behind_it_is_none():
    beat = bytes(packer().heartbeat_encode(6, 8, 0, 0, 4).pack(packer()))
    gate = Gate(0.15, lambda: 5.0)
    assert gate.passes(beat)
    assert not gate.passes(beat + setpoint())
    assert not gate.passes(beat[:-1])


@given(st.binary(max_size=200))
def test_what_is_cut_is_all_there_was(data):
    pieces = b"".join(split_frames(data))
    assert data.startswith(pieces)
    assert len(data) - len(pieces) < 8
