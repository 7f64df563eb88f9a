"""What a vehicle says can be shown, whatever bytes it is; all else of its frames stays."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink

from groundstation.vehicle.legible import legible

VEHICLE = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)


def saying(text: bytes, *, old: bool = False) -> bytes:
    message = mavlink.MAVLink_statustext_message(2, text, 7, 1)
    return bytes(message.pack(VEHICLE, force_mavlink1=old))


def read(frame: bytes) -> mavlink.MAVLink_message:
    """Read a frame as an independent implementation does; a wrong CRC would raise."""
    (message,) = mavlink.MAVLink(None).parse_buffer(bytearray(frame))
    return message


@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize(
    ("said", "shown"),
    [
        (b"Battery low: 12 \xc2\xb0C", "Battery low: 12 °C"),
        (b"cut within a letter: \xc2", "cut within a letter: ?"),
        (b"as PX4 ends it\t", "as PX4 ends it "),
        (b"\x1b[2J\x1b]0;gone\x07", "?[2J?]0;gone?"),
        ("turned \u202e round".encode(), "turned ??? round"),
    ],
)
def test_words_are_shown(said, shown, old):
    message = read(legible(saying(said, old=old)))
    assert message._text_raw.decode() == shown
    assert message.severity == 2
    assert old or (message.id, message.chunk_seq) == (7, 1)


@given(st.binary(max_size=50), st.booleans())
def test_any_bytes_become_text_and_stay_it(text, old):
    frame = legible(saying(text, old=old))
    assert read(frame)._text_raw.partition(b"\0")[0].decode().isprintable()
    assert legible(frame) == frame


@given(st.binary(max_size=16))
def test_so_do_the_names_of_parameters(name):
    frame = bytes(mavlink.MAVLink_param_value_message(name, 2.5, 9, 900, 17).pack(VEHICLE))
    message = read(legible(frame))
    assert message._param_id_raw.partition(b"\0")[0].decode().isprintable()
    assert (message.param_value, message.param_count, message.param_index) == (2.5, 900, 17)


@given(st.binary(min_size=20, max_size=50), st.integers(0, 7))
def test_a_frame_that_was_broken_on_its_way_stays_broken(text, bit):
    frame = bytearray(saying(text))
    frame[20] ^= 1 << bit
    assert legible(bytes(frame)) == frame


def test_other_frames_are_left_alone():
    frame = bytes(VEHICLE.v2_extension_encode(0, 1, 1, 7, b"\xff" * 249).pack(VEHICLE))
    assert legible(frame) == frame
