"""The stick's datagrams: what passes, what does not, and what becomes of the socket."""

from __future__ import annotations

import math
import os
import signal
import socket
import stat
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import DeviceError
from drivers.stick import LAYOUT, MAGIC, StickReceiver, StickSample, StickSender, decode, encode

positions = st.tuples(*(st.floats(-1.0, 1.0),) * 3)
samples = st.builds(
    StickSample,
    t=st.floats(0, 1e9),
    position=positions,
    yaw=st.floats(-math.pi, math.pi),
    buttons=st.integers(0, 2**32 - 1),
)


class Clock:
    def __init__(self, now: float = 100.0) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def path(tmp_path):
    return str(tmp_path / "stick")


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def receiver(path, clock):
    receiver = StickReceiver(path, clock)
    receiver.open()
    yield receiver
    receiver.close()


@pytest.fixture
def sender(path):
    sender = StickSender(path)
    yield sender
    sender.close()


@given(samples)
def test_a_sample_survives_the_wire(sample):
    assert decode(encode(sample)) == sample


def test_the_layout_is_as_documented():
    datagram = encode(StickSample(2.0, (0.25, -0.5, 1.0), -1.5, 5))
    assert len(datagram) == 56
    assert datagram[:8] == b"GSTK\x01\x00\x00\x00"
    assert struct.unpack("<5d", datagram[8:48]) == (2.0, 0.25, -0.5, 1.0, -1.5)
    assert datagram[48:] == b"\x05\x00\x00\x00\x00\x00\x00\x00"


def is_sound(sample: StickSample | None) -> bool:
    return sample is None or (
        math.isfinite(sample.t)
        and all(abs(component) <= 1.0 for component in sample.position)
        and abs(sample.yaw) <= math.pi
    )


@given(st.binary(max_size=128))
def test_no_bytes_raise_or_give_what_is_not_finite(datagram):
    assert is_sound(decode(datagram))


@given(st.tuples(*(st.floats(width=64),) * 5), st.integers(0, 2**32 - 1))
def test_no_numbers_in_a_well_formed_datagram_give_what_is_not_finite(numbers, buttons):
    sample = decode(LAYOUT.pack(MAGIC, 1, *numbers, buttons))
    good = all(map(math.isfinite, numbers)) and all(abs(x) <= 1.0 for x in numbers[1:4])
    assert (sample is not None) == (good and abs(numbers[4]) <= math.pi)
    assert is_sound(sample)


@given(samples, st.integers(0, 55), st.integers(0, 255))
def test_a_flipped_byte_never_gives_what_is_not_finite(sample, index, byte):
    datagram = bytearray(encode(sample))
    datagram[index] = byte
    assert is_sound(decode(bytes(datagram)))


@pytest.mark.parametrize("size", [0, 1, 55, 57, 200])
def test_a_datagram_of_another_length_is_refused(size):
    assert decode(encode(StickSample(1.0, (0.0, 0.0, 0.0), 0.0, 0)).ljust(200, b"\0")[:size]) is None


def test_the_newest_of_several_is_known(receiver, sender, clock):
    for step in range(3):
        assert sender.send((step / 100, 0.0, 0.0), 0.1, 1 << step, clock.now - 0.03 + step / 100)
    assert [sample.buttons for sample in receiver.receive()] == [1, 2, 4]
    assert receiver.fresh(clock.now).position == (0.02, 0.0, 0.0)


def test_bad_datagrams_are_counted_and_change_nothing(receiver, sender, path, clock):
    sender.send((0.01, 0.0, 0.0), 0.0, 0, clock.now)
    good = receiver.receive()
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as stranger:
        stranger.sendto(b"hello", path)
        stranger.sendto(b"", path)
        stranger.sendto(encode(StickSample(clock.now + 0.01, (0.0, 0.0, 0.0), 0.0, 0)) + b"x", path)
        stranger.sendto(LAYOUT.pack(MAGIC, 1, clock.now, math.nan, 0.0, 0.0, 0.0, 0), path)
        stranger.sendto(LAYOUT.pack(MAGIC, 2, clock.now, 0.0, 0.0, 0.0, 0.0, 0), path)
    clock.now += 0.1
    assert receiver.receive() == []
    assert receiver.rejected == 5
    assert receiver.fresh(clock.now) == good[0]


@pytest.mark.parametrize("offset", [0.5, 1e-6, 1e300])
def test_a_sample_from_the_future_cannot_hide_silence(receiver, sender, clock, offset):
    sender.send((0.01, 0.0, 0.0), 0.0, 0, clock.now + offset)
    assert receiver.receive() == []
    assert receiver.rejected == 1


def test_an_older_or_repeated_sample_does_not_replace_a_newer(receiver, sender, clock):
    for t in (clock.now, clock.now - 0.05, clock.now):
        sender.send((t - clock.now, 0.0, 0.0), 0.0, 0, t)
    assert len(receiver.receive()) == 1
    assert receiver.rejected == 2
    assert receiver.fresh(clock.now).t == clock.now


def test_silence_is_an_error_and_ends_when_the_sender_is_back(receiver, sender, clock):
    with pytest.raises(DeviceError, match="no stick yet"):
        receiver.fresh(clock.now)
    sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)
    receiver.receive()
    clock.now += 0.19
    assert receiver.fresh(clock.now)
    clock.now += 0.02
    with pytest.raises(DeviceError, match="silent"):
        receiver.fresh(clock.now)
    sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)
    receiver.receive()
    assert receiver.fresh(clock.now)


def test_a_program_that_sends_what_is_no_number_is_not_called_silent(receiver, sender, clock):
    sender.send((math.nan, 0.0, 0.0), 0.0, 0, clock.now)
    receiver.receive()
    with pytest.raises(DeviceError, match="not a number"):
        receiver.fresh(clock.now)
    sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)
    receiver.receive()
    clock.now += 0.21
    with pytest.raises(DeviceError, match="silent"):
        receiver.fresh(clock.now)
    sender.send((0.0, math.inf, 0.0), 0.0, 0, clock.now)
    receiver.receive()
    with pytest.raises(DeviceError, match="not a number"):
        receiver.fresh(clock.now)


def test_what_queued_up_while_nobody_read_is_not_taken_for_fresh(receiver, sender, clock):
    sender.send((0.05, 0.0, 0.0), 0.0, 0, clock.now)
    clock.now += 5.0
    receiver.receive()
    with pytest.raises(DeviceError, match="silent"):
        receiver.fresh(clock.now)


def test_sending_to_nobody_or_to_a_full_queue_says_so_and_does_not_wait(receiver, sender, tmp_path, clock):
    absent = StickSender(str(tmp_path / "nobody"))
    assert not absent.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)
    absent.close()
    sent = [sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now) for _ in range(5000)]
    assert sent[0]
    assert not sent[-1]
    while receiver.receive() or receiver.rejected < sent.count(True) - 1:
        pass
    assert sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)


def test_a_flood_does_not_hold_up_one_read(path, clock):
    receiver = StickReceiver(path, clock)
    receiver.open()
    stranger = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    stranger.settimeout(0.0)

    class Refilling:
        """Every look at the clock brings another datagram, so the queue never runs dry."""

        def __call__(self) -> float:
            clock.now += 1e-3
            stranger.sendto(encode(StickSample(clock.now, (0.0, 0.0, 0.0), 0.0, 0)), path)
            return clock.now

    receiver._clock = Refilling()
    receiver._clock()
    assert 1 < len(receiver.receive()) <= 64
    stranger.close()
    receiver.close()


def test_only_this_user_can_write_to_the_socket(receiver, path):
    assert stat.S_IMODE(Path(path).stat().st_mode) == 0o600


def test_the_socket_leaves_nothing_behind_and_closes_twice(receiver, path):
    receiver.close()
    assert not Path(path).exists()
    receiver.close()
    with pytest.raises(DeviceError, match="open it first"):
        receiver.receive()


def test_close_leaves_a_successor_alone(receiver, path, clock):
    Path(path).unlink()
    successor = StickReceiver(path, clock)
    successor.open()
    receiver.close()
    assert Path(path).exists()
    successor.close()


def test_a_second_handle_on_the_same_path_is_refused(receiver, sender, path, clock):
    with pytest.raises(DeviceError, match="another handle listens there"):
        StickReceiver(path, clock).open()
    sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)
    assert receiver.receive()


def test_the_socket_of_a_killed_program_is_replaced(path, clock, sender):
    program = f"""
import time
from drivers.stick import StickReceiver
StickReceiver({path!r}, time.monotonic).open()
print("open", flush=True)
time.sleep(60)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE) as dead:
        assert dead.stdout is not None
        assert dead.stdout.readline() == b"open\n"
        os.kill(dead.pid, signal.SIGKILL)
    assert Path(path).exists()
    assert not sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)
    receiver = StickReceiver(path, clock)
    receiver.open()
    assert sender.send((0.0, 0.0, 0.0), 0.0, 0, clock.now)
    assert receiver.receive()
    receiver.close()


def test_a_file_is_never_replaced(tmp_path, clock):
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    with pytest.raises(DeviceError, match="not a socket"):
        StickReceiver(str(file), clock).open()
    assert file.read_text() == "mine"


def test_another_kind_of_socket_is_never_replaced(path, clock):
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as other:
        other.bind(path)
        other.listen()
        with pytest.raises(DeviceError, match="somebody else's socket"):
            StickReceiver(path, clock).open()
        assert Path(path).exists()


@pytest.mark.parametrize("bad", ["/nowhere/at/all/stick", "/tmp/" + "x" * 200])
def test_a_path_that_cannot_be_bound_is_explained(bad, clock):
    with pytest.raises(DeviceError, match="cannot be bound") as caught:
        StickReceiver(bad, clock).open()
    assert bad in str(caught.value)


def test_another_process_moves_the_stick():
    """Nothing here is shared but the path and the machine's monotonic clock."""
    import time

    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/stick"
        receiver = StickReceiver(path, time.monotonic)
        receiver.open()
        program = (
            "import sys, time; from drivers.stick import StickSender; "
            f"sys.exit(not StickSender({path!r}).send((0.01, 0.02, 0.03), 0.4, 5, time.monotonic()))"
        )
        assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
        (sample,) = receiver.receive()
        assert sample[1:] == ((0.01, 0.02, 0.03), 0.4, 5)
        receiver.close()
