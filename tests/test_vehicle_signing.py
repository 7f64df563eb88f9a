"""Signing against two independent implementations: pymavlink's, and the simulated vehicle's."""

import os
from hashlib import sha256

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink

from groundstation.errors import InputError
from groundstation.vehicle.signed_times import TimesKeeper, read_times, times_file
from groundstation.vehicle.signing import Signing, read_key, without_signature
from sim.mavlink.signing import Signing as VehiclesSigning

KEY = bytes(range(32))
NOW = 1.8e9
TICKS = round((NOW - 1_420_070_400) * 1e5)


class Clock:
    def __init__(self):
        self.now = NOW

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def signing(clock):
    return Signing(KEY, clock)


def station(key=None, timestamp=TICKS, system=255):
    """Return pymavlink as an end of a link; with a key it signs."""
    end = mavlink.MAVLink(None, srcSystem=system, srcComponent=190)
    if key:
        end.signing.secret_key, end.signing.sign_outgoing = key, True
        end.signing.timestamp = timestamp
    return end


def heartbeat(end) -> bytes:
    return bytes(end.heartbeat_encode(6, 8, 0, 0, 4).pack(end))


def time_of(signed: bytes) -> int:
    return int.from_bytes(signed[-12:-6], "little")


def of_random_length(end, number, length) -> bytes:
    """Return a message whose payload has any length, zeros at its end cut or not."""
    text = bytes(number + each & 0xFF for each in range(length))
    return bytes(end.v2_extension_encode(0, 1, 1, number, text.ljust(249, b"\0")).pack(end))


@given(st.integers(0, 60_000), st.integers(0, 249))
def test_pymavlink_takes_what_is_signed_whatever_its_length(number, length):
    plain = of_random_length(station(), number, length)
    signed = Signing(KEY, lambda: NOW).sign(plain)
    reader = station(KEY)
    reader.signing.allow_unsigned_callback = lambda *_: False
    (message,) = reader.parse_buffer(signed)
    # A wrong CRC or signature would have been BAD_DATA.
    assert message.get_type() == "V2_EXTENSION"
    assert message.get_signed()
    assert message.message_type == number
    assert signed[10 : 10 + signed[1]] == plain[10 : 10 + plain[1]]


def test_the_vehicle_takes_it_too_and_only_with_its_key(signing):
    plain = heartbeat(station())
    command = station().command_long_encode(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    for frame in (plain, bytes(command.pack(station()))):
        signed = signing.sign(frame)
        message = mavlink.MAVLink(None).decode(bytearray(signed))
        assert VehiclesSigning(lambda: NOW, KEY).trusts(signed, message)
        if message.get_type() != "HEARTBEAT":
            assert not VehiclesSigning(lambda: NOW, bytes(32)).trusts(signed, message)


def test_what_pymavlink_signs_is_heard_once(signing):
    end = station(KEY)
    first, second = heartbeat(end), heartbeat(end)
    assert signing.trusts(second)
    # Again, and from before: both are replays.
    assert not signing.trusts(second)
    assert not signing.trusts(first)
    assert signing.trusts(heartbeat(end))


def test_each_stream_has_its_own_time(signing):
    assert signing.trusts(heartbeat(station(KEY, system=1)))
    assert signing.trusts(heartbeat(station(KEY, system=2)))


@pytest.mark.parametrize("seconds", [-61.0, -3600.0])
def test_a_stream_that_begins_in_the_past_is_an_old_recording(signing, seconds):
    assert not signing.trusts(heartbeat(station(KEY, TICKS + round(seconds * 1e5))))
    assert signing.trusts(heartbeat(station(KEY, TICKS - 30 * 100_000)))


def test_a_vehicle_whose_clock_is_far_behind_follows_ours(signing):
    """As with PX4 before it has the time: refused until it has heard us, and taken our time."""
    vehicle = station(KEY, 1000, system=1)
    assert not signing.trusts(heartbeat(vehicle))
    assert vehicle.parse_buffer(signing.sign(heartbeat(station())))[0].get_type() == "HEARTBEAT"
    assert signing.trusts(heartbeat(vehicle))


def test_no_time_is_believed_that_leaves_no_room(signing):
    assert not signing.trusts(heartbeat(station(KEY, 1 << 47)))
    assert signing.trusts(heartbeat(station(KEY, (1 << 47) - 10)))


def test_unsigned_wrongly_signed_and_older_frames_are_refused(signing):
    assert not signing.trusts(heartbeat(station()))
    assert not signing.trusts(heartbeat(station(bytes(32))))
    old = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    frame = bytes(old.heartbeat_encode(6, 8, 0, 0, 4).pack(old, force_mavlink1=True))
    assert frame[0] == 0xFE
    assert not signing.trusts(frame)
    assert signing.sign(frame) == b""


def test_a_radio_has_no_key_and_is_not_heard(signing):
    radio = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    assert not signing.trusts(bytes(radio.radio_status_encode(200, 190, 90, 50, 50, 0, 0).pack(radio)))


@given(st.data())
def test_no_bit_may_differ(data):
    frame = bytearray(heartbeat(station(KEY)))
    at = data.draw(st.integers(0, len(frame) - 1))
    frame[at] ^= 1 << data.draw(st.integers(0, 7))
    assert not Signing(KEY, lambda: NOW).trusts(bytes(frame))


def test_a_forged_frame_does_not_keep_the_true_ones_out(signing):
    forged = bytearray(heartbeat(station(KEY, TICKS + 10**9)))
    forged[-1] ^= 1
    assert not signing.trusts(bytes(forged))
    assert signing.trusts(heartbeat(station(KEY)))


def test_timestamps_rise_however_the_wall_clock_jumps(signing, clock):
    times = []
    for jump in (0.0, 0.0, 3600.0, -7200.0, 0.0, 1.0):
        clock.now += jump
        times.append(time_of(signing.sign(heartbeat(station()))))
    assert times == sorted(set(times))
    assert times[0] == TICKS


def test_a_key_that_others_may_read_is_no_key(tmp_path):
    path = tmp_path / "key"
    path.write_bytes(KEY)
    path.chmod(0o640)
    with pytest.raises(InputError, match=r"--signing-key: .*chmod 600"):
        read_key(path)
    path.chmod(0o600)
    assert read_key(path) == KEY
    path.write_text("too few")
    with pytest.raises(InputError, match="8 characters or more"):
        read_key(path)
    with pytest.raises(InputError, match="check the path"):
        read_key(tmp_path / "none")


def test_what_looks_like_a_key_and_is_none_is_refused_at_once(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe, 0o600)
    for path in (pipe, tmp_path):
        with pytest.raises(InputError, match=f"--signing-key: {path}: "):
            read_key(path)
    path = tmp_path / "long"
    path.touch(0o600)
    path.write_bytes(b"x" * 100_000)
    with pytest.raises(InputError, match="neither 32 bytes nor"):
        read_key(path)


@pytest.mark.parametrize("text", ["thirty-one characters, and a newline"[:31] + "\n", "x" * 32, "x" * 8])
def test_text_is_a_passphrase_whatever_its_length(tmp_path, text):
    path = tmp_path / "key"
    path.touch(0o600)
    path.write_text(text)
    assert read_key(path) == sha256(text.rstrip("\n").encode()).digest()


@given(st.binary(min_size=32, max_size=32))
def test_bytes_by_chance_are_the_key_itself(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "chance"
    path.touch(0o600)
    path.write_bytes(b"\x00" + data[1:])
    assert read_key(path) == b"\x00" + data[1:]


@given(st.integers(0, 60_000), st.integers(0, 249))
def test_without_its_signature_a_frame_is_what_it_was(number, length):
    plain = of_random_length(station(), number, length)
    assert without_signature(Signing(KEY, lambda: NOW).sign(plain)) == plain
    assert without_signature(plain) == plain


class TestAfterARestart:
    @pytest.fixture
    def key(self, tmp_path):
        path = tmp_path / "key"
        path.touch(0o600)
        path.write_bytes(KEY)
        return path

    def restarted(self, key, signing, clock):
        told = []
        TimesKeeper(key, signing, told.append).close()
        assert not told
        times, why = read_times(key)
        assert not why
        return Signing(KEY, clock, times)

    def test_what_was_heard_before_is_not_heard_again(self, key, signing, clock):
        vehicle = station(KEY, system=1)
        recorded = [heartbeat(vehicle) for _ in range(3)]
        assert all(map(signing.trusts, recorded))
        after = self.restarted(key, signing, clock)
        assert not any(map(after.trusts, recorded))
        assert after.trusts(heartbeat(vehicle))

    def test_not_even_with_the_clock_put_back_a_year(self, key, signing, clock):
        recorded = heartbeat(station(KEY, system=7))
        signing.sign(heartbeat(station()))
        clock.now -= 365 * 86_400
        after = self.restarted(key, signing, clock)
        assert not after.trusts(heartbeat(station(KEY, TICKS - 61 * 100_000, system=7)))
        assert time_of(after.sign(heartbeat(station()))) > TICKS
        # Without them it would be.
        assert Signing(KEY, clock).trusts(recorded)

    def test_senders_of_long_ago_take_no_place(self, key, signing, clock):
        for system in range(1, 17):
            assert signing.trusts(heartbeat(station(KEY, system=system)))
        assert not signing.trusts(heartbeat(station(KEY, system=17)))
        clock.now += 100.0
        signing.sign(heartbeat(station()))
        after = self.restarted(key, signing, clock)
        assert after.trusts(heartbeat(station(KEY, TICKS + 100 * 100_000, system=17)))

    def test_only_we_may_read_them_and_a_damaged_file_is_told(self, key, signing, clock):
        self.restarted(key, signing, clock)
        assert times_file(key).stat().st_mode & 0o777 == 0o600
        assert sorted(path.name for path in key.parent.iterdir()) == ["key", "key.times"]
        times_file(key).write_text("{")
        times, why = read_times(key)
        assert times.newest == 0
        assert "is damaged" in why

    def test_what_cannot_be_kept_is_told_once(self, tmp_path, signing):
        told = []
        keeper = TimesKeeper(tmp_path / "gone" / "key", signing, told.append)
        keeper.close()
        assert len(told) == 1
        assert "could be played again" in told[0]
