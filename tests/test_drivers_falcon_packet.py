"""The Falcon's bytes: golden vectors, round trips, and what a bad line makes of them."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.emulators.faults import Faults
from drivers.falcon.guard import Guard
from drivers.falcon.packet import (
    ALL_LEGS,
    BLUE,
    GREEN,
    RED,
    Reader,
    Reply,
    Request,
    encode_reply,
    encode_request,
)

words = st.integers(-32768, 32767)
replies = st.builds(Reply, st.tuples(words, words, words), st.integers(0, 15), st.integers(0, 7))


def slow_reply(reply):
    """The layout as it is written down, nibble by nibble: an independent encoder."""
    body = []
    for count in reply.encoders:
        body += [(count >> shift) & 15 for shift in (0, 4, 8, 12)]
    return b"<" + bytes(0x41 + n for n in [*body, reply.buttons | reply.legs << 4, 0]) + b">"


def test_bytes_worked_out_by_hand():
    assert encode_request(Request((0, 0, 0), homing=True)) == b"<AAAAAAAAAAAABA>"
    # 0x0ABC is sent C B A 0, −1 is 0xFFFF, −4095 is 0xF001.
    assert encode_request(Request((0x0ABC, -1, -4095), RED)) == b"<MLKAPPPPBAAPJA>"
    assert encode_request(Request((0, 0, 0), GREEN | BLUE, homing=False)) == b"<AAAAAAAAAAAAGA>"
    # All buttons on a homed grip: 0x41 + 0x7F, far above the nibbles' range.
    assert encode_reply(Reply((1, 0x1234, -2), 15, 7)) == b"<BAAAEDCBOPPP\xc0A>"
    assert Reader().replies(b"<BAAAEDCBOPPP\xc0A>") == [Reply((1, 0x1234, -2), 15, 7)]


@pytest.mark.parametrize(("bit", "at"), [(1, "plus"), (2, "forward"), (4, "centre"), (8, "minus")])
def test_each_button_has_its_bit(bit, at):
    assert Reader().replies(b"<AAAAAAAAAAAA%cA>" % (0x41 + bit)) == [Reply((0, 0, 0), bit, 0)]


@pytest.mark.parametrize("force", [4096, -4096, 32768, -70000])
def test_a_force_that_would_wrap_is_refused(force):
    with pytest.raises(ValueError, match="4095"):
        encode_request(Request((0, force, 0)))


@given(replies)
def test_a_reply_survives_the_wire(reply):
    packet = encode_reply(reply)
    assert packet == slow_reply(reply)
    assert Reader().replies(packet) == [reply]


@given(st.tuples(*(st.integers(-4095, 4095),) * 3), st.integers(0, 7), st.booleans())
def test_a_request_survives_the_wire(forces, lights, homing):
    request = Request(forces, lights << 1, homing)
    assert Reader().requests(encode_request(request)) == [request]


def test_a_hundred_thousand_random_packets_survive_in_pieces_of_any_size():
    chance = random.Random(3)
    sent = [
        Reply(
            (chance.randint(-32768, 32767), chance.randint(-32768, 32767), chance.randint(-32768, 32767)),
            chance.randint(0, 15),
            chance.randint(0, 7),
        )
        for _ in range(100_000)
    ]
    stream = b"".join(map(encode_reply, sent))
    reader, come, at = Reader(), [], 0
    while at < len(stream):
        size = chance.randint(1, 700)
        come += reader.replies(stream[at : at + size])
        at += size
    assert come == sent
    assert reader.passed_over == 0


@given(st.binary(max_size=200))
def test_no_bytes_raise_and_what_is_found_is_in_the_bytes(data):
    reader = Reader()
    assert all(encode_reply(reply) in data for reply in reader.replies(data))
    assert reader.replies(encode_reply(Reply((1, 2, 3), 4, 5)))[-1:] == [Reply((1, 2, 3), 4, 5)]


@pytest.mark.parametrize(
    "bad",
    [
        b"<AAAAAAAAAAAA>",  # 14 bytes, which another driver takes for "homed, all buttons"
        b"<AAAAAAAAAAAAAB>",
        b"<AAAAAAAAAAAQAA>",
        b"<AAAAAAAAAAAA\xc1A>",
        b"<AAAAAAAAAAAA@A>",
        b"<AAAAAAAAAAAAAAA>",
        b"AAAAAAAAAAAAAA>",
        b"<AAAAAAAAAAAAAA",
    ],
)
def test_what_is_not_a_packet_is_passed_over_and_the_next_is_found(bad):
    good = Reply((5, 6, 7), 2, 7)
    reader = Reader()
    assert reader.replies(bad) == []
    assert reader.replies(encode_reply(good)) == [good]
    assert reader.passed_over == len(bad)


@settings(max_examples=40)
@given(st.integers(0, 2**32), st.sampled_from([(0.05, 0, 0), (0, 0.05, 0), (0, 0, 0.05), (0.02, 0.02, 0.02)]))
def test_after_any_fault_the_next_whole_packet_is_found(seed, shares):
    faults, reader = Faults(*shares, random.Random(seed)), Reader()
    for number in range(300):
        packet = encode_reply(Reply((number, -number, 7), 5, 7))
        come = faults.spoil(packet)
        found = reader.replies(come)
        if come == packet:
            assert found[-1].encoders == (number, -number, 7)


@pytest.mark.parametrize("shares", [(0.01, 0, 0), (0, 0.01, 0), (0, 0, 0.01), (0.01 / 3,) * 3, (0.01,) * 3])
def test_one_per_cent_bad_bytes_make_no_event(shares):
    """The run of 10⁶ is `python -m bench falcon`; this one has no changes of buttons at all: any is false."""
    faults, reader, guard = Faults(*shares, random.Random(5)), Reader(), Guard()
    events, held, behind = 0, (0, False), 0
    for tick in range(100_000):
        # At rest most of all: equal nibbles hide a shift.
        packet = encode_reply(Reply((0, 0, 0) if tick < 50_000 else (tick // 100, -7, 4), 0, ALL_LEGS))
        come = faults.spoil(packet)
        believed = [guard.take(tick * 1e-3, reply) for reply in reader.replies(come)]
        behind = 0 if True in believed else behind + (come == packet)
        assert behind < 2, "not in step after two whole replies"
        if (guard.buttons, guard.homed) != held:
            events += 1
            held = (guard.buttons, guard.homed)
    assert faults.events > 10_000
    assert (events, held) == (1, (0, True))


def test_without_agreement_the_same_line_does_make_false_events():
    """What the guard is there for: the test above can fail."""
    faults, reader, false = Faults(*(0.01,) * 3, random.Random(5)), Reader(), 0
    for _ in range(100_000):
        for reply in reader.replies(faults.spoil(encode_reply(Reply((0, 0, 0), 0, ALL_LEGS)))):
            false += (reply.buttons, reply.legs) != (0, ALL_LEGS)
    assert false > 10


def test_three_that_agree_are_an_event_and_two_are_not():
    guard = Guard()
    for tick, buttons in enumerate([4, 4, 0, 4, 4, 4, 4]):
        assert guard.buttons == (4 if tick == 6 else 0)
        guard.take(tick * 1e-3, Reply((0, 0, 0), buttons, 0))
    assert guard.buttons == 4
    assert not guard.homed


@pytest.mark.parametrize("legs", range(7))
def test_homed_is_all_legs(legs):
    guard = Guard()
    for tick in range(5):
        guard.take(tick * 1e-3, Reply((0, 0, 0), 0, legs))
    assert not guard.homed


def test_a_jump_is_not_believed_until_the_next_reply_is_there_too():
    guard = Guard()
    t = iter(range(100))

    def take(*counts):
        return guard.take(next(t) * 1e-3, Reply(counts, 0, 7))

    assert [take(0, 0, 0) for _ in range(3)] == [False, True, True]
    assert not take(0, 4096, 0)
    assert take(1, 0, 0)
    assert not take(300, 300, 300)
    assert take(301, 300, 300)
    assert not take(1, 0, 0)
    assert take(2, 0, 0)
    assert guard.refused == 4
