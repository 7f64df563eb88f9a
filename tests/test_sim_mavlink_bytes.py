"""Frames among garbage, and a vehicle that no datagram can break."""

import math
import random

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import DT, NAN, Wire

from sim.autopilot.parameters import NAMES, SPECS
from sim.mavlink.wire import Inbox, Outbox


def test_frames_are_found_between_garbage_and_across_pieces():
    packer = m.MAVLink(None, srcSystem=1, srcComponent=1)
    frames_ = [m.MAVLink_ping_message(number, 0, 0, 0).pack(packer) for number in range(5)]
    noise = bytes([0xFD, 0xFF, 0x00, 0x13, 0xFE, 0xFD])
    data = noise + frames_[0] + noise + frames_[1] + frames_[2] + b"\xfd" + frames_[3] + frames_[4]
    # What looks like a long frame at first may be one: only more bytes tell.
    for inbox, pieces in ((Inbox(), [data]), (Inbox(), [data[i : i + 1] for i in range(len(data))])):
        whole = len(pieces) == 1
        found = [message for piece in pieces for message in inbox.messages(piece, whole=whole)]
        if not whole:
            found += inbox.messages(b"", whole=True)
        assert [message.time_usec for message in found] == [0, 1, 2, 3, 4]


def test_a_text_of_just_full_chunks_is_ended_by_an_empty_one():
    outbox, inbox = Outbox(1), Inbox()
    outbox.say(2, "x" * 100)
    texts = [message for datagram in outbox.take() for message in inbox.messages(datagram, whole=True)]
    assert [(text.chunk_seq, len(text.text)) for text in texts] == [(0, 50), (1, 50), (2, 0)]


ODD_FLOATS = (0.0, -0.0, 1.0, -1.0, 4.0, 6.0, 32.0, 21196.0, 0.5, NAN, math.inf, -math.inf, 3.4e38, 1e-40)
COMMANDS = (400, 176, 22, 21, 20, 185, 192, 178, 511, 510, 512, 520, 1, 65535)


def odd_message(kind, rng):
    """Return a message to us of any kind with odd values in all its fields."""
    values = []
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    for name, type_ in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        length = lengths[name]
        if name in ("target_system", "target_component"):
            values.append(1)
        elif name == "command":
            values.append(rng.choice(COMMANDS))
        elif type_ == "char":
            values.append(rng.choice([b"MIS_TAKEOFF_ALT", b"COM_OBL_RC_ACT", b"", b"\xff" * length]))
        elif type_ in ("float", "double"):
            values.append(
                [rng.choice(ODD_FLOATS) for _ in range(length)] if length else rng.choice(ODD_FLOATS)
            )
        else:
            bits = int(type_.removesuffix("_t").lstrip("uint"))
            lowest = 0 if type_.startswith("u") else -(1 << (bits - 1))
            choices = (0, 1, lowest, lowest + (1 << bits) - 1, rng.randrange(1 << (bits - 1)))
            values.append([rng.choice(choices) for _ in range(length)] if length else rng.choice(choices))
    return kind(*values)


def valid_frames(wire):
    packer = wire.packer
    return [
        m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3).pack(packer),
        m.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0).pack(packer),
        m.MAVLink_command_int_message(1, 1, 6, 192, 0, 0, -1, 1, 0, 0, 1, 2, 3).pack(packer),
        m.MAVLink_set_position_target_local_ned_message(0, 1, 1, 8, 1479, *[0] * 11).pack(packer),
        m.MAVLink_param_set_message(1, 1, b"MIS_TAKEOFF_ALT", 3.0, 9).pack(packer),
        m.MAVLink_timesync_message(0, 1).pack(packer),
    ]


@pytest.mark.parametrize("seed", range(4))
def test_five_hundred_broken_datagrams_break_nothing(seed):
    rng = random.Random(seed)
    wire = Wire("dynamic").take_off()
    handled = sorted(wire.endpoint.links[0].handled)
    for number in range(500):
        if number % 2:
            data = bytearray(b"".join(rng.choices(valid_frames(wire), k=rng.randint(1, 3))))
            for _ in range(rng.randint(1, 6)):
                data[rng.randrange(len(data))] = rng.randrange(256)
            data = data[: rng.randint(0, len(data))] if rng.random() < 0.3 else data
        else:
            data = odd_message(m.mavlink_map[rng.choice(handled)], rng).pack(wire.packer)
        wire.endpoint.receive(bytes(data))
        if number % 5 == 0:
            wire.run(DT)
            assert all(math.isfinite(value) for value in (*wire.sim.p, *wire.sim.v))
    assert wire.ask(m.MAVLink_ping_message(1, 2, 0, 0), "PING").seq == 2
    assert all(
        SPECS[name].lowest <= wire.sim.autopilot.parameters[name] <= SPECS[name].highest for name in NAMES
    )
